"""Places in a field: rings about an axis, sectors of azimuth, and two axes square to each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
