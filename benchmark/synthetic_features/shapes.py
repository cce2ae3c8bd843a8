"""Shapes of one spot, integrated over the pixel, and how a camera reads them (`frame_sets`).

Heights are one in the middle, rims are blurred by a Gaussian; lengths are pixels.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

BACKGROUND_E = 20.0
READ_NOISE_E = 10.0
#: Sigma of a rim.
EDGE_PX = 0.7
#: Light further out than this from a rim is left out: below 1e-8 of it.
_TAIL_PX = 6.0 * EDGE_PX
#: Points of Gauss-Legendre quadrature across a pixel.
_QUADRATURE = 4
#: Of the Sun in visible light: I(mu) = 1 - u (1 - mu).
_LIMB = 0.6
#: Where the first dark ring of ``(2 J1(t) / t)^2`` is, and half of its light.
_DARK_RING, _HALF_LIGHT = 3.8317, 1.6163


@dataclass(frozen=True)
class Shape:
    """Light of one spot.

    Attributes
    ----------
    light
        At offsets x, y from its middle, turned by an angle in radians.
    half_px
        Half its width at half its light, across where it is drawn out.
    longest_px
        Half its longest axis; to the first dark ring where it has one.
    reach_px
        Beyond this there is no light to speak of.
    """

    light: Callable[[Floats, Floats, float], Floats]
    half_px: float
    longest_px: float
    reach_px: float


def _up_to(edge: Floats) -> Floats:
    """Share of a blurred rim's light a distance inside it, in sigmas."""
    from scipy.special import ndtr  # noqa: PLC0415 - SciPy where frames are drawn

    return np.asarray(ndtr(edge))


def disc(radius: float) -> Shape:
    """Return a uniform disc."""

    def light(x: Floats, y: Floats, _: float) -> Floats:
        return np.asarray(_up_to((radius - np.hypot(x, y)) / EDGE_PX))

    return Shape(light, radius, radius, radius + _TAIL_PX)


def gaussian(sigma: float) -> Shape:
    """Return a round Gaussian."""
    half = sigma * math.sqrt(2.0 * math.log(2.0))

    def light(x: Floats, y: Floats, _: float) -> Floats:
        return np.asarray(np.exp(-(x**2 + y**2) / (2.0 * sigma**2)))

    return Shape(light, half, half, 6.0 * sigma)


def airy(ring: float) -> Shape:
    """Return the pattern of a round hole whose first dark ring has this radius."""
    scale = ring / _DARK_RING

    def light(x: Floats, y: Floats, _: float) -> Floats:
        from scipy.special import j1  # noqa: PLC0415 - SciPy where frames are drawn

        t = np.hypot(x, y) / scale + 1e-9
        return np.asarray((2.0 * j1(t) / t) ** 2)

    return Shape(light, scale * _HALF_LIGHT, ring, 5.0 * ring)


def stretch(radius: float, incidence_deg: float) -> Shape:
    """Return a disc drawn out along one axis as by light of this incidence; its rim is not."""
    k = 1.0 / math.cos(math.radians(incidence_deg))

    def light(x: Floats, y: Floats, turn: float) -> Floats:
        u, v = _turn(x, y, turn)
        rho = np.maximum(np.hypot(u / k, v), 1e-9)
        slope = np.maximum(np.hypot(u / k**2, v), 1e-9) / rho
        return np.asarray(_up_to((radius - rho) / slope / EDGE_PX))

    return Shape(light, radius, k * radius, k * radius + _TAIL_PX)


def square(half: float) -> Shape:
    """Return a uniform square."""

    def light(x: Floats, y: Floats, turn: float) -> Floats:
        u, v = _turn(x, y, turn)
        return np.asarray(
            _up_to((half - np.abs(u)) / EDGE_PX) * _up_to((half - np.abs(v)) / EDGE_PX)
        )

    return Shape(light, half, half, math.sqrt(2.0) * half + _TAIL_PX)


def limb_darkened(radius: float) -> Shape:
    """Return a disc as bright as the Sun's at each distance from its middle."""

    def light(x: Floats, y: Floats, _: float) -> Floats:
        rho = np.hypot(x, y)
        mu = np.sqrt(np.maximum(1.0 - (rho / radius) ** 2, 0.0))
        return np.asarray((1.0 - _LIMB * (1.0 - mu)) * _up_to((radius - rho) / EDGE_PX))

    return Shape(light, radius, radius, radius + _TAIL_PX)


def _turn(x: Floats, y: Floats, turn: float) -> tuple[Floats, Floats]:
    c, s = math.cos(turn), math.sin(turn)
    return x * c + y * s, y * c - x * s


def render(shape: Shape, centres: Floats, turns: Floats, size_px: int) -> Floats:
    """Mean over each pixel of spots at (N, 2), turned by (N,): frames (N, size, size)."""
    frames = np.zeros((len(centres), size_px, size_px))
    nodes, weights = np.polynomial.legendre.leggauss(_QUADRATURE)
    reach = math.ceil(shape.reach_px) + 1
    for frame, (x, y), turn in zip(frames, centres, turns, strict=True):
        columns, rows = (_near(float(c), reach, size_px) for c in (x, y))
        if not len(columns) or not len(rows):
            continue
        fine_x, fine_y = (
            (np.array(pixels)[:, None] - middle + nodes / 2.0).ravel()
            for pixels, middle in ((columns, x), (rows, y))
        )
        light = shape.light(fine_x[None, :], fine_y[:, None], float(turn))
        cells = light.reshape(len(rows), _QUADRATURE, len(columns), _QUADRATURE)
        frame[rows.start : rows.stop, columns.start : columns.stop] = np.einsum(
            "iajb,a,b->ij", cells, weights / 2.0, weights / 2.0
        )
    return frames


def _near(centre: float, reach: int, size: int) -> range:
    middle = round(centre)
    return range(max(middle - reach, 0), min(middle + reach + 1, size))


def read_out(mean_e: Floats, bits: int, rng: np.random.Generator) -> NDArray[Any]:
    """Digital numbers of mean electrons, one each: Poisson and read noise, whole and clipped."""
    signal = rng.poisson(mean_e) + rng.normal(0.0, READ_NOISE_E, mean_e.shape)
    return np.clip(np.rint(signal), 0, 2**bits - 1).astype(np.uint16)


def variance_e(mean_e: Floats) -> Floats:
    """Variance of `read_out`: light, read noise and rounding; clipping is left out."""
    return np.asarray(mean_e + READ_NOISE_E**2 + 1.0 / 12.0)
