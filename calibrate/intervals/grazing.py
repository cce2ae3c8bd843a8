"""Errors of sensors with faces where light grazes one of them: a strip narrower than any ring.

Close to the plane square to its normal a face goes dark, and its neighbour opposite does not see
the Sun yet: readings hardly tell how far the Sun is from that plane. A degree beside it they do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from calibrate.intervals.places import tangent_axes

#: Half widths of strips that are tried, degrees, and how many times the variance grows in them.
_REACHES = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0)
_GROWN = tuple(2.0**power for power in range(-2, 8))
#: How many times likelier errors must be with strips than without.
_LIKELIER = 100.0
#: Samples that strips must be worth.
_FEWEST = 20.0
_SHARE = 0.95
_HALVINGS = 40


@dataclass(frozen=True)
class Grazing:
    """By how much the scale of errors along a face's normal grows where light grazes the face.

    At `sine`, of the angle from a face's plane, it grows no more; `grown` is the variance along the
    normal that is added in the plane, over that around it.
    """

    normals: Floats  # (P, 3), of each face; none where the scale does not grow
    sine: float = 1.0
    grown: float = 0.0

    @classmethod
    def none(cls) -> Grazing:
        """Return that of a sensor whose errors do not grow."""
        return cls(np.zeros((0, 3)))

    def times(self, sun: Floats) -> Floats:
        """Return what the scale (N, 2) of two tangent axes grows by at directions (N, 3)."""
        return np.asarray(np.sqrt(1.0 + self.grown * _shares(sun, self.normals, self.sine)))


def grazing_of(over: Floats, answers: Floats, normals: Floats) -> Grazing:
    """Return where errors grow, if they clearly do.

    How wide strips are is what makes the errors likeliest; how much the scale grows there, what
    holds 95 % of them, since errors in strips are far from normal. Errors (N, 2) along the tangent
    axes are over their scale by place; directions (N, 3) are those answered, known in flight.
    """
    if not len(normals) or not over.any():
        return Grazing.none()
    best, found = np.log(_LIKELIER), Grazing.none()
    plain = _likelihood(over, np.ones_like(over))
    for reach in _REACHES:
        sine = float(np.sin(np.radians(reach)))
        shares = _shares(answers, normals, sine)
        if shares.sum() < _FEWEST:
            continue
        for grown in _GROWN:
            gained = _likelihood(over, np.sqrt(1.0 + grown * shares)) - plain
            if gained > best:
                best, found = gained, Grazing(normals, sine, grown)
    return found if not len(found.normals) else _held_by(found, over, answers)


def _held_by(found: Grazing, over: Floats, answers: Floats) -> Grazing:
    """Return strips of the same width in which the scale grows by what holds 95 % of errors."""
    shares = _shares(answers, found.normals, found.sine)
    limit = float(np.quantile(over[shares == 0.0], _SHARE))
    low, high = 0.0, 16.0 * _GROWN[-1]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        inside = over <= limit * np.sqrt(1.0 + middle * shares)
        held = float(np.average(inside, weights=shares))
        low, high = (low, middle) if held >= _SHARE else (middle, high)
    return Grazing(found.normals, found.sine, high)


def _shares(sun: Floats, normals: Floats, sine: float) -> Floats:
    """Return how far each tangent axis (N, 2) is that of a face whose plane is near; 0 to 1 each.

    Summed over the faces; falling with the square of the distance from the plane.
    """
    near = np.maximum(1.0 - ((sun @ normals.T) / sine) ** 2, 0.0)
    along = np.stack([axis @ normals.T for axis in tangent_axes(sun)], axis=1)
    return np.asarray(np.einsum("np,nap->na", near, along**2))


def _likelihood(over: Floats, times: Floats) -> float:
    """Return the logarithm of the likelihood of sizes (N, 2) whose mean goes with `times`."""
    even = over / times
    return -float(np.log(times).sum()) - over.size * float(np.log(even.mean()))
