"""Compiled rendering of displaced apertures on a pixel grid (loaded on first use: Numba).

Scan lines cross each row at Gauss nodes; along a line the two rims of an aperture give exact
pixel coverage through an accumulation buffer (differences first, one running sum a row at the
end). Where an outline starts or ends, nodes follow ``y = u^2``, which straightens a round rim's
square-root start. An outline is a tuple ``(kind, cx, cy, ux, uy, a, b, c, s)``: centres of the
lower and the upper rim, half sizes, cosine and sine of the rotation, pixels.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Outline = tuple[float, float, float, float, float, float, float, float, float]
Interval = tuple[float, float]

_FEW_X, _FEW_W = np.polynomial.legendre.leggauss(3)
_MANY_X, _MANY_W = np.polynomial.legendre.leggauss(8)
#: Rows in which a rim runs over more pixels than this take the fine rule.
_STEEP_PX = 0.75
_INNER, _START, _END = 0, 1, 2


def _box_chord_py(y: float, outline: Outline) -> Interval:
    """``|c dx + s dy| <= a and |c dy - s dx| <= b`` solved for dx."""
    _, cx, cy, _, _, a, b, c, s = outline
    dy = y - cy
    left, right = -1e300, 1e300
    if abs(c) > 1e-15:
        one, two = (-a - s * dy) / c, (a - s * dy) / c
        left, right = max(left, min(one, two)), min(right, max(one, two))
    if abs(s) > 1e-15:
        one, two = (c * dy - b) / s, (c * dy + b) / s
        left, right = max(left, min(one, two)), min(right, max(one, two))
    return cx + left, cx + right


_box_chord = njit(cache=True)(_box_chord_py)


def _chord_py(y: float, outline: Outline) -> Interval:
    """Left and right end of the lit part of a scan line; left > right when there is none."""
    kind, cx, cy, ux, uy, a, _, _, _ = outline
    if kind > 0.5:
        return _box_chord(y, outline)
    half = math.sqrt(max(a * a - (y - cy) * (y - cy), 0.0))
    left, right = cx - half, cx + half
    if ux != cx or uy != cy:
        half = math.sqrt(max(a * a - (y - uy) * (y - uy), 0.0))
        left, right = max(left, ux - half), min(right, ux + half)
    return left, right


_chord = njit(cache=True)(_chord_py)


def _outline_py(aperture: Floats, lower: Floats, upper: Floats, origin: Floats) -> Outline:
    """Both rims of one aperture in window coordinates; boxes already intersected into one."""
    kind, x, y, a, b, c, s = aperture
    x, y = x - origin[0], y - origin[1]
    cx, cy, ux, uy = x + lower[0], y + lower[1], x + upper[0], y + upper[1]
    if kind > 0.5:
        dx, dy = ux - cx, uy - cy
        a = a - abs(c * dx + s * dy) / 2.0
        b = b - abs(c * dy - s * dx) / 2.0
        cx, cy = (cx + ux) / 2.0, (cy + uy) / 2.0
        ux, uy = cx, cy
    return kind, cx, cy, ux, uy, a, b, c, s


_outline = njit(cache=True)(_outline_py)


def _lens_extent_py(outline: Outline) -> Interval:
    """Lowest and highest y of the intersection of two equal discs; equal when it is empty."""
    _, cx, cy, ux, uy, radius, _, _, _ = outline
    dx, dy = ux - cx, uy - cy
    apart = math.sqrt(dx * dx + dy * dy)
    if apart == 0.0:
        return cy - radius, cy + radius
    if apart >= 2.0 * radius:
        return 0.0, 0.0
    # corners of the lens end it, unless a disc's own extreme point lies inside the other
    corner = abs(math.sqrt(radius * radius - apart * apart / 4.0) * dx / apart)
    middle = (cy + uy) / 2.0
    low, high = middle - corner, middle + corner
    extreme = radius - abs(dy)
    if extreme * extreme + dx * dx <= radius * radius:
        low, high = max(cy, uy) - radius, min(cy, uy) + radius
    return low, high


_lens_extent = njit(cache=True)(_lens_extent_py)


def _extent_py(outline: Outline) -> Interval:
    """Lowest and highest y of an outline; equal when it is empty."""
    kind, _, cy, _, _, a, b, c, s = outline
    if kind < 0.5:
        return _lens_extent(outline)
    if a <= 0.0 or b <= 0.0:
        return 0.0, 0.0
    reach = a * abs(s) + b * abs(c)
    return cy - reach, cy + reach


_extent = njit(cache=True)(_extent_py)


def _edge_py(line: Floats, x: float, value: float) -> None:
    """Add a step of `value` at `x` to a row of differences (W + 2 long)."""
    x = min(max(x, 0.0), line.shape[0] - 2.0)
    column = int(x)
    share = x - column
    line[column] += value * (1.0 - share)
    line[column + 1] += value * share


_edge = njit(cache=True)(_edge_py)


def _strip_py(line: Floats, outline: Outline, span: Interval, end: int, weight: float) -> None:
    """Add the part of an outline between two heights of one row.

    `end` tells whether the outline starts at the lower (`_START`) or ends at the upper height
    (`_END`); `weight` is the light of a fully lit pixel.
    """
    y0, length = span[0], span[1] - span[0]
    fine = end != _INNER
    if not fine:
        left, right = _chord(span[0], outline)
        other_left, other_right = _chord(span[1], outline)
        fine = max(abs(left - other_left), abs(right - other_right)) > _STEEP_PX
    nodes, shares = (_MANY_X, _MANY_W) if fine else (_FEW_X, _FEW_W)
    for q in range(len(nodes)):
        u, share = (nodes[q] + 1.0) / 2.0, shares[q] / 2.0
        if end == _INNER:
            y = y0 + length * u
        elif end == _START:
            y, share = y0 + length * u * u, share * 2.0 * u
        else:
            y, share = span[1] - length * u * u, share * 2.0 * u
        left, right = _chord(y, outline)
        if right > left:
            value = weight * length * share
            _edge(line, left, value)
            _edge(line, right, -value)


_strip = njit(cache=True)(_strip_py)


def _shape_py(differences: Floats, outline: Outline, weight: float) -> None:
    """Add an outline to the rows of differences, (H, W + 2)."""
    low, high = _extent(outline)
    height = differences.shape[0]
    if high <= low or high <= 0.0 or low >= height:
        return
    for row in range(max(math.floor(low), 0), min(math.ceil(high), height)):
        y0, y1 = max(low, float(row)), min(high, row + 1.0)
        line = differences[row]
        if y0 == low and y1 == high:
            middle = (y0 + y1) / 2.0
            _strip(line, outline, (y0, middle), _START, weight)
            _strip(line, outline, (middle, y1), _END, weight)
        elif y0 == low:
            _strip(line, outline, (y0, y1), _START, weight)
        elif y1 == high:
            _strip(line, outline, (y0, y1), _END, weight)
        else:
            _strip(line, outline, (y0, y1), _INNER, weight)


_shape = njit(cache=True)(_shape_py)


def _render_py(
    flux: Floats, apertures: Floats, rims: Floats, light: Floats, origin: Floats
) -> None:
    """Write the light in every pixel of every frame.

    Parameters
    ----------
    flux
        (N, H, W), overwritten: share of each pixel's area lit, times the light.
    apertures
        (A, 7) `Mask.table` in pixels.
    rims
        (2, N, K, 2) displacement of the mask's lower and upper rims, px.
    light
        (N, K) light of each of the K points of the Sun.
    origin
        (N, 2) position of the window's first corner (not its first pixel's centre), px, in the
        frame of `apertures`.
    """
    count, height, width = flux.shape
    differences = np.zeros((height, width + 2))
    for n in range(count):
        differences[:] = 0.0
        for k in range(light.shape[1]):
            if light[n, k] == 0.0:
                continue
            for m in range(apertures.shape[0]):
                outline = _outline(apertures[m], rims[0, n, k], rims[1, n, k], origin[n])
                _shape(differences, outline, light[n, k])
        for row in range(height):
            total = 0.0
            for column in range(width):
                total += differences[row, column]
                flux[n, row, column] = max(total, 0.0)


render: Callable[[Floats, Floats, Floats, Floats, Floats], None] = njit(cache=True)(_render_py)
