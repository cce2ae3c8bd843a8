"""The Sun as a limb-darkened disc, sampled by a fixed set of weighted directions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SolarDisc:
    """A disc of radiance ``1 - u (1 - sqrt(1 - r^2))`` at the relative radius r.

    Attributes
    ----------
    diameter_deg
        Full angle; 0 makes the Sun a point.
    limb_darkening
        Linear coefficient u in [0, 1]; 0.6 is the photosphere in the visible band.
    rings
        Directions on each ring of the quadrature, from the inside out. Multiples of four keep
        the set symmetric about both tangent axes, so that it adds no bias of its own.
    """

    diameter_deg: float = 0.533
    limb_darkening: float = 0.6
    rings: tuple[int, ...] = (8, 12, 16, 20, 24, 28)

    def __post_init__(self) -> None:
        if not 0 <= self.diameter_deg < 90:
            raise ValueError(f"diameter_deg must be in [0, 90); got {self.diameter_deg}")
        if not 0 <= self.limb_darkening <= 1:
            raise ValueError(f"limb_darkening must be in [0, 1]; got {self.limb_darkening}")
        if not self.rings or any(n < 4 or n % 4 for n in self.rings):
            raise ValueError(f"rings must be positive multiples of four; got {self.rings}")

    def quadrature(self) -> tuple[Floats, Floats]:
        """Tangent-plane offsets and weights of the quadrature.

        Returns
        -------
        offsets
            (K, 2) sines of the angle from the disc's centre along the two tangent axes.
        weights
            (K,) shares of the Sun's light, sum 1.
        """
        return _quadrature(self)

    def directions(self, sun: Floats) -> Floats:
        """Return unit vectors to the K points of the disc, (N, K, 3), for centres `sun` (N, 3)."""
        offsets, _ = self.quadrature()
        first, second = tangent_axes(sun)
        along = np.sqrt(1.0 - np.sum(offsets**2, axis=1))
        return np.asarray(
            along[None, :, None] * sun[:, None, :]
            + offsets[None, :, 0, None] * first[:, None, :]
            + offsets[None, :, 1, None] * second[:, None, :]
        )


@lru_cache(maxsize=32)
def _quadrature(disc: SolarDisc) -> tuple[Floats, Floats]:
    if disc.diameter_deg == 0:
        return np.zeros((1, 2)), np.ones(1)
    nodes, shares = np.polynomial.legendre.leggauss(len(disc.rings))
    area = (nodes + 1.0) / 2.0  # r^2 is uniform over the disc's area
    radiance = 1.0 - disc.limb_darkening * (1.0 - np.sqrt(1.0 - area))
    reach = math.sin(math.radians(disc.diameter_deg / 2.0))
    offsets: list[tuple[float, float]] = []
    weights: list[float] = []
    for count, part, share in zip(disc.rings, area, shares * radiance, strict=True):
        for step in range(count):
            angle = 2.0 * math.pi * (step + 0.5) / count
            radius = reach * math.sqrt(part)
            offsets.append((radius * math.cos(angle), radius * math.sin(angle)))
            weights.append(share / count)
    total = math.fsum(weights)
    points, shares_of_light = np.array(offsets), np.array(weights) / total
    points.flags.writeable = shares_of_light.flags.writeable = False
    return points, shares_of_light


def tangent_axes(sun: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors (N, 3) that with `sun` (N, 3) make right-handed orthogonal triads.

    The first is the sensor's x axis projected on the tangent plane (its y axis within 26 deg of
    the x axis, where that projection would shrink).
    """
    reference = np.where(np.abs(sun[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = reference - np.sum(reference * sun, axis=1, keepdims=True) * sun
    first /= np.sqrt(np.sum(first**2, axis=1, keepdims=True))
    return first, np.cross(sun, first)


def from_angles(alpha_deg: Floats, beta_deg: Floats) -> Floats:
    """Return unit vectors (N, 3) with ``tan(alpha) = s_y/s_z`` and ``tan(beta) = s_x/s_z``.

    Tangents come from the C library, not from NumPy's processor-dependent ones, so that the
    same directions come out on every machine.
    """
    across = np.array([math.tan(math.radians(angle)) for angle in beta_deg])
    along = np.array([math.tan(math.radians(angle)) for angle in alpha_deg])
    vectors = np.column_stack([across, along, np.ones(len(across))])
    return np.asarray(vectors / np.sqrt(np.sum(vectors**2, axis=1, keepdims=True)))
