"""Sunlight on faces by the response that they have in common: `sunlight`."""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats

KNOTS = np.array([0.0, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0])
"""Cosines of incidence at which a response is learnt; straight between them."""
LIT = 0.2
"""Share of full sunlight from which a face is lit by the Sun: the Earth alone gives less."""

#: Steps of least squares to the sunlight.
_STEPS = 4
#: Cosine to the other side up to which a face may still see the Sun.
_PAST = 0.02


def sunlight(signals: Floats, normals: Floats, response: Floats) -> Floats:
    """Return sunlight (N, 3) by least squares, of signals (N, K) in units of one Sun.

    First by the faces that are surely lit, then by all that look towards what was found.

    Parameters
    ----------
    signals : ndarray, shape (N, K)
        Without the Earth's light.
    normals : ndarray, shape (K, 3)
        Of the faces.
    response : ndarray, shape (9,)
        Of every face at `KNOTS`.
    """
    surely = (signals > LIT / 2.0).astype(np.float64)
    cosine = surely * np.interp(signals, response, KNOTS)
    sun = _stepped(np.zeros((len(signals), 3)), surely, cosine, normals)
    for _ in range(_STEPS):
        direct, slope = seen_of(sun, normals, response)
        sun = _stepped(sun, slope, signals - direct, normals)
    return sun


def seen_of(sun: Floats, normals: Floats, response: Floats) -> tuple[Floats, Floats]:
    """Return signals (N, K) of sunlight (N, 3), and their slopes with the cosine of incidence."""
    cosine = sun @ normals.T
    c = np.clip(cosine, 0.0, 1.0)
    steps = np.diff(response) / np.diff(KNOTS)
    slope = steps[np.clip(np.searchsorted(KNOTS, c) - 1, 0, len(steps) - 1)]
    # a face that looks a little past the Sun may look at it after the step
    return np.interp(c, KNOTS, response), np.where(cosine > -_PAST, slope, 0.0)


def _stepped(sun: Floats, slope: Floats, left: Floats, normals: Floats) -> Floats:
    """Sunlight (N, 3) after a step of Gauss and Newton; where no face tells, it stays."""
    matrix = np.einsum("nk,ki,kj->nij", slope**2, normals, normals) + 1e-4 * np.eye(3)
    right = np.einsum("nk,ki->ni", slope * left, normals)
    return np.asarray(sun + np.linalg.solve(matrix, right[:, :, None])[:, :, 0])
