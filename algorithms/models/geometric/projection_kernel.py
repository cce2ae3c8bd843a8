"""Sun vectors of spots behind a pinhole, as drawn and as `lsq` has it, many rows at a time."""

from __future__ import annotations

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

_BLOCK = 128
"""Rows that stay in the first cache; inner loops run along them, several at a time."""


@compiled
def project(x: Floats, y: Floats, centre: tuple[float, float], scale: float, sun: Floats) -> None:
    """Sun vectors (N, 3) of spots, into `sun`: what `sun_from_tangents` makes of their tangents.

    Parameters
    ----------
    x, y : ndarray, shape (N,)
        Features.
    centre : tuple of two float
        Feature (x, y) on the boresight.
    scale : float
        Tangent for one unit of feature.
    sun : ndarray, shape (N, 3)
        Overwritten; a NaN row where a feature is NaN or no number can hold the tangents' squares.
    """
    left, low = centre
    part = np.empty((3, _BLOCK))
    along, across, length = part[0], part[1], part[2]
    for start in range(0, len(x), _BLOCK):
        size = min(_BLOCK, len(x) - start)
        u, v = x[start : start + size], y[start : start + size]
        for i in range(size):
            along[i] = (u[i] - left) * scale
            across[i] = (v[i] - low) * scale
            root = np.sqrt(across[i] * across[i] + along[i] * along[i] + 1.0)
            length[i] = root if root < np.inf else np.nan
        # NumPy's quotients: Python's would ask each divisor whether it is zero
        for i in range(size):
            along[i] = np.divide(along[i], length[i])
            across[i] = np.divide(across[i], length[i])
            length[i] = np.divide(1.0, length[i])
        for i in range(size):
            sun[start + i, 0] = along[i]
            sun[start + i, 1] = across[i]
            sun[start + i, 2] = length[i]


@compiled
def project_and_turn(
    x: Floats,
    y: Floats,
    lines: tuple[tuple[float, float], tuple[float, float], float],
    turns: tuple[float, float, float, float],
    sun: Floats,
) -> None:
    """Sun vectors (N, 3) of spots by eq:lsq, into `sun`.

    Without a trigonometric function: sines and cosines of an arc tangent are roots, and the
    boresight's offsets turn them.

    Parameters
    ----------
    x, y : ndarray, shape (N,)
        Features.
    lines : tuple
        Zero point (x, y), tangents there (across, along), and tangent for one unit of feature.
    turns : tuple of four float
        Sine and cosine of beta_0, sine and cosine of alpha_0.
    sun : ndarray, shape (N, 3)
        Overwritten.
    """
    (left, low), (tan_beta, tan_alpha), scale = lines
    sin_beta, cos_beta, sin_alpha, cos_alpha = turns
    part = np.empty((4, _BLOCK))
    across, along, one, other = part[0], part[1], part[2], part[3]
    for start in range(0, len(x), _BLOCK):
        size = min(_BLOCK, len(x) - start)
        u, v = x[start : start + size], y[start : start + size]
        for i in range(size):
            across[i] = (u[i] - left) * scale + tan_beta
            along[i] = (v[i] - low) * scale + tan_alpha
            one[i] = np.sqrt(1.0 + across[i] * across[i])
        # NumPy's quotients: Python's would ask each divisor whether it is zero
        for i in range(size):
            along[i] = np.divide(along[i], one[i])
            one[i] = np.divide(1.0, one[i])
            other[i] = np.divide(1.0, np.sqrt(1.0 + along[i] * along[i]))
        for i in range(size):
            across[i] = across[i] * one[i]
            along[i] = along[i] * other[i]
        for i in range(size):
            level = other[i] * cos_alpha + along[i] * sin_alpha
            sun[start + i, 0] = (across[i] * cos_beta - one[i] * sin_beta) * level
            sun[start + i, 1] = along[i] * cos_alpha - other[i] * sin_alpha
            sun[start + i, 2] = (one[i] * cos_beta + across[i] * sin_beta) * level


@compiled
def cast_by_homography(
    tangents: Floats, numbers: Floats, slope: float, centre: tuple[float, float], out: Floats
) -> None:
    """Places (N, 2) of stretched tangents (N, 2) on a plane behind a pinhole, into `out`.

    Parameters
    ----------
    tangents : ndarray, shape (N, 2)
        In the mask's frame.
    numbers : ndarray, shape (10,)
        The homography's first eight elements by rows, and two coefficients of the stretch.
    slope : float
        Tangent for one unit of place.
    centre : tuple of two float
        Place (x, y) on the boresight.
    out : ndarray, shape (N, 2)
        Overwritten; a NaN row where the plane does not reach.
    """
    left, low = centre
    for i in range(len(tangents)):
        x, y = tangents[i, 0], tangents[i, 1]
        square = x * x + y * y
        stretch = 1.0 + square * (numbers[8] + square * numbers[9])
        x, y = x * stretch, y * stretch
        depth = numbers[6] * x + numbers[7] * y + 1.0
        if depth > 0:
            across = (numbers[0] * x + numbers[1] * y + numbers[2]) / depth
            along = (numbers[3] * x + numbers[4] * y + numbers[5]) / depth
            out[i, 0] = np.divide(across, slope) + left
            out[i, 1] = np.divide(along, slope) + low
        else:
            out[i, 0] = out[i, 1] = np.nan
