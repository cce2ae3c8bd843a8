"""Compiled rendering of displaced apertures on a pixel grid (loaded on first use: Numba).

Scan lines cross each row at Gauss nodes; along a line the two rims of an aperture give exact
pixel coverage through an accumulation buffer (differences first, one running sum a row at the
end). Where an outline starts or ends, nodes follow ``y = u^2``, which straightens a round rim's
square-root start.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_FEW_X, _FEW_W = np.polynomial.legendre.leggauss(3)
_MANY_X, _MANY_W = np.polynomial.legendre.leggauss(8)
#: Rows whose rim runs over more pixels than this take the fine rule.
_STEEP_PX = 0.75


def _disc_chord(y: float, cx: float, cy: float, radius: float) -> tuple[float, float]:
    rest = radius * radius - (y - cy) * (y - cy)
    half = math.sqrt(rest) if rest > 0.0 else 0.0
    return cx - half, cx + half


def _box_chord(
    y: float, cx: float, cy: float, a: float, b: float, c: float, s: float
) -> tuple[float, float]:
    dy = y - cy
    left, right = -1e300, 1e300
    # |c dx + s dy| <= a and |c dy - s dx| <= b
    if abs(c) > 1e-15:
        one, two = (-a - s * dy) / c, (a - s * dy) / c
        left, right = max(left, min(one, two)), min(right, max(one, two))
    if abs(s) > 1e-15:
        one, two = (c * dy - b) / s, (c * dy + b) / s
        left, right = max(left, min(one, two)), min(right, max(one, two))
    return cx + left, cx + right


_disc = njit(cache=True, inline="always")(_disc_chord)
_box = njit(cache=True, inline="always")(_box_chord)


def _chord(
    y: float,
    kind: float,
    cx: float,
    cy: float,
    ux: float,
    uy: float,
    a: float,
    b: float,
    c: float,
    s: float,
) -> tuple[float, float]:
    """Both rims' chords intersected (round), or the chord of a box (both rims are one box)."""
    if kind > 0.5:
        return _box(y, cx, cy, a, b, c, s)
    left, right = _disc(y, cx, cy, a)
    if ux != cx or uy != cy:
        other_left, other_right = _disc(y, ux, uy, a)
        left, right = max(left, other_left), min(right, other_right)
    return left, right


_chords = njit(cache=True)(_chord)


def _add_edge(acc: Floats, row: int, x: float, width: int, value: float) -> None:
    x = min(max(x, 0.0), float(width))
    column = int(x)
    share = x - column
    acc[row, column] += value * (1.0 - share)
    acc[row, column + 1] += value * share


_edge = njit(cache=True, inline="always")(_add_edge)


def _rim_extent(cy: float, ux: float, cx: float, uy: float, radius: float) -> tuple[float, float]:
    """Lowest and highest y of the intersection of two equal discs; low >= high when empty."""
    dx, dy = ux - cx, uy - cy
    apart2 = dx * dx + dy * dy
    if apart2 == 0.0:
        return cy - radius, cy + radius
    if apart2 >= 4.0 * radius * radius:
        return 0.0, 0.0
    # corners of the lens; they end it unless a disc's own extreme point lies inside the other
    apart = math.sqrt(apart2)
    height = math.sqrt(radius * radius - apart2 / 4.0)
    middle = (cy + uy) / 2.0
    corner = abs(height * dx / apart)
    low, high = middle - corner, middle + corner
    top_x, top_y = (cx, cy) if cy < uy else (ux, uy)
    other_x, other_y = (ux, uy) if cy < uy else (cx, cy)
    if (top_x - other_x) ** 2 + (top_y + radius - other_y) ** 2 <= radius * radius:
        high = top_y + radius
    if (other_x - top_x) ** 2 + (other_y - radius - top_y) ** 2 <= radius * radius:
        low = other_y - radius
    return low, high


_extent = njit(cache=True)(_rim_extent)


def _render(
    flux: Floats,
    apertures: Floats,
    lower: Floats,
    upper: Floats,
    weights: Floats,
    origin: Floats,
) -> None:
    """Write the light in every pixel of every frame.

    Parameters
    ----------
    flux
        (N, H, W), overwritten: share of each pixel's area lit, times the weights.
    apertures
        (A, 7) `Mask.table` in pixels, from the point that projects along the optical axis.
    lower, upper
        (N, K, 2) displacement of the mask's lower and upper rim, px.
    weights
        (N, K) light of each of the K points of the Sun.
    origin
        (N, 2) position of the window's first corner (not its first pixel's centre), px, in the
        frame of `apertures`.
    """
    count, height, width = flux.shape
    points = lower.shape[1]
    acc = np.zeros((height, width + 2))
    for n in range(count):
        acc[:] = 0.0
        for k in range(points):
            weight = weights[n, k]
            if weight == 0.0:
                continue
            for m in range(apertures.shape[0]):
                kind = apertures[m, 0]
                a, b = apertures[m, 3], apertures[m, 4]
                c, s = apertures[m, 5], apertures[m, 6]
                cx = apertures[m, 1] + lower[n, k, 0] - origin[n, 0]
                cy = apertures[m, 2] + lower[n, k, 1] - origin[n, 1]
                ux = apertures[m, 1] + upper[n, k, 0] - origin[n, 0]
                uy = apertures[m, 2] + upper[n, k, 1] - origin[n, 1]
                if kind > 0.5:
                    # two displaced equal boxes intersect in one smaller box
                    dx, dy = ux - cx, uy - cy
                    a -= abs(c * dx + s * dy) / 2.0
                    b -= abs(c * dy - s * dx) / 2.0
                    if a <= 0.0 or b <= 0.0:
                        continue
                    cx, cy = (cx + ux) / 2.0, (cy + uy) / 2.0
                    ux, uy = cx, cy
                    reach = a * abs(s) + b * abs(c)
                    low, high = cy - reach, cy + reach
                else:
                    low, high = _extent(cy, ux, cx, uy, a)
                if high <= low or high <= 0.0 or low >= height:
                    continue
                first, last = max(int(math.floor(low)), 0), min(int(math.ceil(high)), height)
                for row in range(first, last):
                    y0, y1 = max(low, float(row)), min(high, float(row + 1))
                    starts, ends = y0 == low, y1 == high
                    pieces = 2 if starts and ends else 1
                    for piece in range(pieces):
                        ya, yb = y0, y1
                        at_start, at_end = starts, ends
                        if pieces == 2:
                            if piece == 0:
                                yb, at_end = (y0 + y1) / 2.0, False
                            else:
                                ya, at_start = (y0 + y1) / 2.0, False
                        span = yb - ya
                        fine = at_start or at_end
                        if not fine:
                            la, ra = _chords(ya, kind, cx, cy, ux, uy, a, b, c, s)
                            lb, rb = _chords(yb, kind, cx, cy, ux, uy, a, b, c, s)
                            fine = max(abs(la - lb), abs(ra - rb)) > _STEEP_PX
                        nodes = 8 if fine else 3
                        for q in range(nodes):
                            if fine:
                                u, share = (_MANY_X[q] + 1.0) / 2.0, _MANY_W[q] / 2.0
                            else:
                                u, share = (_FEW_X[q] + 1.0) / 2.0, _FEW_W[q] / 2.0
                            if at_start:
                                y = ya + span * u * u
                                share *= 2.0 * u
                            elif at_end:
                                y = yb - span * u * u
                                share *= 2.0 * u
                            else:
                                y = ya + span * u
                            left, right = _chords(y, kind, cx, cy, ux, uy, a, b, c, s)
                            if right > left and right > 0.0 and left < width:
                                value = weight * span * share
                                _edge(acc, row, left, width, value)
                                _edge(acc, row, right, width, -value)
        for row in range(height):
            total = 0.0
            for column in range(width):
                total += acc[row, column]
                flux[n, row, column] = max(total, 0.0)


render: Callable[[Floats, Floats, Floats, Floats, Floats, Floats], None] = njit(cache=True)(_render)
