"""Scale of errors by place: rings about an axis, sectors, and where light grazes a face."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from algorithms.calibration.hull import Hull
from algorithms.contract import Floats

#: Most rings, and sectors of each: a table that flight code can hold.
MOST_RINGS, SECTORS = 12, 8
#: Samples for each ring.
_A_RING = 40
#: Length of the mean direction from which a field is one-sided, and angle of the mean to the
#: boresight from which rings lie about the mean.
_ONE_SIDED, _ASIDE_DEG = 0.3, 20.0
#: Off-axis angle of the last ring from which it is a point, as the first is.
_ALL_AROUND_DEG = 170.0


def hull_of_poses(sun: Floats) -> Hull:
    """Return the cone of directions (N, 3), found once for the same: of 100,000 it takes 2 s.

    UnusableDataError if they lie in one plane through the sensor.
    """
    return _hull_of(np.asarray(sun, dtype=np.float64).tobytes())


@lru_cache(maxsize=1)
def _hull_of(poses: bytes) -> Hull:
    return Hull.of_directions(np.frombuffer(poses).reshape(-1, 3), "poses")


@dataclass(frozen=True)
class Grid:
    """Ring and sector centres about an axis (3,).

    The first sector is at the azimuth of +x (of +y about an axis within 26 deg of x).
    """

    axis: Floats
    rings_deg: Floats  # off-axis angles (K,), from 0 on
    sectors: int

    @classmethod
    def over(cls, sun: Floats) -> Grid:
        """Return the grid over directions (N, 3): about the boresight where it can.

        About the middle of the directions where they lie to one side of the boresight.
        """
        middle = sun.mean(axis=0)
        length = float(np.linalg.norm(middle))
        aside = middle[2] < np.cos(np.radians(_ASIDE_DEG)) * length
        axis = middle / length if length > _ONE_SIDED and aside else np.array([0.0, 0.0, 1.0])
        count = int(np.clip(len(sun) // _A_RING, 2, MOST_RINGS))
        reach = float(np.degrees(np.arccos(np.clip((sun @ axis).min(), -1.0, 1.0))))
        return cls(axis, np.linspace(0.0, max(reach, 1e-6), count), SECTORS)

    @property
    def points(self) -> list[int]:
        """Rings that are a point: the first, and the last of a field all around."""
        last = len(self.rings_deg) - 1
        return [0, last] if self.rings_deg[-1] > _ALL_AROUND_DEG else [0]

    def centres(self) -> Floats:
        """Return the directions (K, M, 3) of the centres."""
        first, second = self._zero()
        off = np.radians(np.maximum(self.rings_deg, 1e-3))[:, None, None]
        turn = np.radians(360.0 / self.sectors * np.arange(self.sectors))[:, None]
        around = np.cos(turn) * first + np.sin(turn) * second
        return np.asarray(np.cos(off) * self.axis + np.sin(off) * around)

    def weights(self, sun: Floats) -> tuple[Floats, Floats]:
        """Return the weights (N, K) and (N, M) of linear interpolation at directions (N, 3).

        Periodic in azimuth, constant beyond the last ring; NaN of NaN.
        """
        first, second = self._zero()
        x, y = sun @ first, sun @ second
        off = np.degrees(np.arctan2(np.hypot(x, y), sun @ self.axis))
        at = np.interp(off, self.rings_deg, np.arange(len(self.rings_deg), dtype=np.float64))
        rings = np.maximum(1.0 - np.abs(at[:, None] - np.arange(len(self.rings_deg))), 0.0)
        apart = np.arctan2(y, x)[:, None] / (2.0 * np.pi) * self.sectors - np.arange(self.sectors)
        apart -= self.sectors * np.round(apart / self.sectors)
        return rings, np.maximum(1.0 - np.abs(apart), 0.0)

    def _zero(self) -> tuple[Floats, Floats]:
        """Return the directions of azimuth 0 and 90 deg."""
        towards = [1.0, 0.0, 0.0] if abs(self.axis[0]) < 0.9 else [0.0, 1.0, 0.0]
        first = np.asarray(towards) - (self.axis @ towards) * self.axis
        first /= np.linalg.norm(first)
        return first, np.cross(self.axis, first)


def off_axis_deg(sun: Floats) -> Floats:
    """Return the angle (N,) of directions (N, 3) from the boresight."""
    return np.asarray(np.degrees(np.arctan2(np.linalg.norm(sun[:, :2], axis=1), sun[:, 2])))


def bilinear(weights: tuple[Floats, Floats], table: Floats) -> Floats:
    """Return the values (N, 2) of a table (K, M, 2) at the weights that `Grid.weights` gives."""
    return np.asarray(np.einsum("nk,nm,kma->na", *weights, table, optimize=True))


def tangent_axes(sun: Floats) -> tuple[Floats, Floats]:
    """Return two unit vectors (N, 3) square to directions (N, 3) and to each other.

    The first is the direction times x, or times y where the direction is within 26 deg of the x
    axis; the second is the direction times the first.
    """
    first = np.cross(sun, np.where(np.abs(sun[:, [0]]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
    first /= np.linalg.norm(first, axis=1)[:, None]
    return first, np.cross(sun, first)


def radial_parts(sun: Floats, axis: Floats) -> Floats:
    """Return the cosines (N, 2) of both tangent axes to the direction away from an axis (3,)."""
    away = (sun @ axis)[:, None] * sun - axis
    away /= np.maximum(np.linalg.norm(away, axis=1), 1e-12)[:, None]
    return np.column_stack([(one * away).sum(axis=1) for one in tangent_axes(sun)])


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
