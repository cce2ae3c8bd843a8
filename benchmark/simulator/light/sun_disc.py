"""The Sun as a limb-darkened disc, sampled by a fixed set of weighted directions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from algorithms.contract import Floats


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
        the set symmetric about both tangent axes, so that it adds no bias of its own. Gauss's
        radii and weights: best for what changes smoothly over the disc, such as areas.
    spiral
        Where not 0, so many directions of equal light on a spiral take the place of the rings:
        best for pixels smaller than the Sun's image, of which every single direction lights some
        fully and some not at all. A multiple of four too: the set is the same turned by 90 deg.
    """

    diameter_deg: float = 0.533
    limb_darkening: float = 0.6
    rings: tuple[int, ...] = (8, 12, 16, 20, 24, 28)
    spiral: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.diameter_deg < 90:
            raise ValueError(f"diameter_deg must be in [0, 90); got {self.diameter_deg}")
        if not 0 <= self.limb_darkening <= 1:
            raise ValueError(f"limb_darkening must be in [0, 1]; got {self.limb_darkening}")
        if not self.rings or any(n < 4 or n % 4 for n in self.rings):
            raise ValueError(f"rings must be positive multiples of four; got {self.rings}")
        if self.spiral < 0 or self.spiral % 4:
            raise ValueError(f"spiral must be 0 or a positive multiple of four; got {self.spiral}")

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
    if disc.spiral:
        return _spiral(disc)
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


#: Golden section of a full turn: no two of its multiples come close.
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def _spiral(disc: SolarDisc) -> tuple[Floats, Floats]:
    """Place sets of four directions a quarter turn apart, each for an annulus of equal light.

    Turned by golden sections from annulus to annulus, so that along any line through the disc the
    projected points lie evenly. A set stands at its annulus' mean squared radius: the second
    moments are the disc's to rounding, odd ones vanish.
    """
    annuli = disc.spiral // 4
    reach = math.sin(math.radians(disc.diameter_deg / 2.0))
    darkening = disc.limb_darkening
    whole, _ = _light_within(1.0, darkening)
    points = np.empty((disc.spiral, 2))
    before = (0.0, 0.0)
    for number in range(annuli):
        edge = 1.0
        if number + 1 < annuli:
            edge = _radius2_holding(whole * (number + 1) / annuli, darkening)
        within = _light_within(edge, darkening)
        square = (within[1] - before[1]) / (within[0] - before[0])
        before = within
        radius = reach * math.sqrt(square)
        turn = math.pi / 2.0 * ((number * _GOLDEN) % 1.0)
        x, y = radius * math.cos(turn), radius * math.sin(turn)
        points[4 * number : 4 * number + 4] = (x, y), (-y, x), (-x, -y), (y, -x)
    shares = np.full(disc.spiral, 1.0 / disc.spiral)
    points.flags.writeable = shares.flags.writeable = False
    return points, shares


def _light_within(square: float, darkening: float) -> tuple[float, float]:
    """Integrals of the radiance, and of it times the squared radius, up to a squared radius.

    Over the squared radius, relative to the disc's.
    """
    rest = 1.0 - square
    root = rest * math.sqrt(rest)
    plain, dimmed = 1.0 - darkening, darkening
    light = plain * square + dimmed * 2.0 / 3.0 * (1.0 - root)
    moment = plain * square**2 / 2.0
    moment += dimmed * (4.0 / 15.0 - 2.0 / 3.0 * root + 2.0 / 5.0 * root * rest)
    return light, moment


def _radius2_holding(light: float, darkening: float) -> float:
    """Return the squared radius within which there is so much light, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2.0
        if _light_within(middle, darkening)[0] < light:
            low = middle
        else:
            high = middle
    return (low + high) / 2.0


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
