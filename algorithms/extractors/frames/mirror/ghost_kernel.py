"""Odd light that a spot's own slopes do not explain: another light upon it.

The last stage of `mirror.registration`, which says what the arrays hold. A weaker light a
little beside a spot makes it skew. Of all odd shapes, the cubic ones times the spot's light are
what is left of that in lowest order once the slopes are fitted.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.mirror import taps

Line = NDArray[np.float32]

#: Rows around the core; lanes of the sums; lines end at multiples of the last.
_REACH, _LANES, _WHOLE = 7, 16, 64
_ZERO, _HALF = np.float32(0.0), np.float32(0.5)
#: What the slopes miss, over the peak, as the fit has it.
_FLOOR = 0.0005
#: What the slopes' own noise adds to departures.
_OWN = taps.noise_of_slopes()[0]
#: A pixel counts as lit above this fraction of the peak.
_CUT = np.float32(0.1)
#: Slopes along both axes, and the four cubic shapes.
_SLOPES, _TERMS = 2, 6
#: Sums of products that their normal equations need.
_SUMS = 24
#: Chi squared, of four degrees of freedom, of what is skew, over the scatter, and its share of the
#: light, squared, from both of which on there is a second light upon the spot.
_SURELY, _MUCH = 20.0, 0.0004
#: Pairs of pixels, lit or not, up to which spots are looked at: larger ones show a second light's
#: outline.
_MOST = 4000


@compiled
def _fold(lanes: Line, which: int) -> float:
    """Sum of the lanes of one of several sums, halves added to halves."""
    p = which * _LANES
    for j in range(_LANES // 2):
        lanes[p + j] += lanes[p + j + _LANES // 2]
    a, b = float(lanes[p]) + lanes[p + 1], float(lanes[p + 2]) + lanes[p + 3]
    c, e = float(lanes[p + 4]) + lanes[p + 5], float(lanes[p + 6]) + lanes[p + 7]
    total: float = (a + b) + (c + e)
    return total


@compiled
def _more(state: Floats) -> float:
    """Variance of a pair's departure over that of the noise of its pixels: see the outliers'."""
    total = 1.0
    for axis in range(2):
        d2, own = state[14 + axis] * state[14 + axis], 0.0
        for k in range(_OWN.size):
            own = own * d2 + _OWN[_OWN.size - 1 - k]
        total += 0.5 * d2 * own
    return total


@compiled
def _weighted(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, e: Line, state: Floats, w: Line, lanes: Line
) -> tuple[float, float]:
    """Write what lit pairs weigh; return the weighted squares of the departures and of the light.

    No shapes explain more than all of the first.
    """
    more = _more(state)
    noise, gain = np.float32(more * (state[0] + _FLOOR * _FLOOR)), np.float32(more * state[1])
    lanes[:] = _ZERO
    for k in range(0, w.size, _LANES):
        for j in range(_LANES):
            q = np.uint64(k) + np.uint64(j)  # what is never negative is vectorised
            light = mean[q] if mean[q] > _CUT else _ZERO
            half = _HALF * keep[q] if light > _ZERO else _ZERO
            weight = np.divide(half, noise + gain * light)
            w[q] = weight
            lanes[j] += weight * e[q] * e[q]
            lanes[j + _LANES] += weight * light * light
    return _fold(lanes, 0), _fold(lanes, 1)


@compiled
def _places(box: Any, scale: float, x: Line, y: Line) -> None:
    """Write x and y of the core's pairs, from the middle, times a scale."""
    stride, factor = box[4], np.float32(scale)
    for j in range(stride):
        x[j] = factor * np.float32(j - 0.5 * (box[3] - 1))
    for i in range(box[7]):
        first, along = (
            np.uint64(i * stride),
            factor * np.float32(box[6] + i - 0.5 * (box[2] - box[1])),
        )
        for j in range(stride):
            q = first + np.uint64(j)
            x[q] = x[j]
            y[q] = along
    for j in range(box[7] * stride, x.size):
        x[j], y[j] = _ZERO, _ZERO


@compiled
def _of_slopes(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, p: int, stride: int, w: Line, e: Line, x: Line, y: Line, lanes: Line
) -> None:
    """Write weighted products of the slopes along both axes to the lanes.

    With each other (3), with the departure (2), and with the cubic shapes x^3, x^2 y, x y^2 and y^3
    times the light (4 for each axis). The core begins at `p` of `s`.
    """
    lanes[:] = _ZERO
    for k in range(0, w.size, _LANES):
        for j in range(_LANES):
            q = np.uint64(k) + np.uint64(j)
            at = np.uint64(p) + q
            a = s[at + np.uint64(1)] - s[at - np.uint64(1)]
            b = s[at + np.uint64(stride)] - s[at - np.uint64(stride)]
            u, v = w[q] * a, w[q] * b
            lanes[j] += u * a
            lanes[j + _LANES] += u * b
            lanes[j + 2 * _LANES] += v * b
            lanes[j + 3 * _LANES] += u * e[q]
            lanes[j + 4 * _LANES] += v * e[q]
            u, v = u * s[at], v * s[at]
            xx, xy, yy = x[q] * x[q], x[q] * y[q], y[q] * y[q]
            lanes[j + 5 * _LANES] += u * x[q] * xx
            lanes[j + 6 * _LANES] += u * x[q] * xy
            lanes[j + 7 * _LANES] += u * x[q] * yy
            lanes[j + 8 * _LANES] += u * y[q] * yy
            lanes[j + 9 * _LANES] += v * x[q] * xx
            lanes[j + 10 * _LANES] += v * x[q] * xy
            lanes[j + 11 * _LANES] += v * x[q] * yy
            lanes[j + 12 * _LANES] += v * y[q] * yy


@compiled
def _of_cubes(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, p: int, w: Line, e: Line, x: Line, y: Line, lanes: Line
) -> None:
    """Write weighted products of the cubic shapes to the lanes, after those of the slopes.

    With the departure (4), and with each other: x^6, x^5 y ... y^6 times the light's square.
    """
    for k in range(0, w.size, _LANES):
        for j in range(_LANES):
            q = np.uint64(k) + np.uint64(j)
            lit = s[np.uint64(p) + q]
            u = w[q] * lit
            v = u * lit
            u *= e[q]
            xx, xy, yy = x[q] * x[q], x[q] * y[q], y[q] * y[q]
            lanes[j + 13 * _LANES] += u * x[q] * xx
            lanes[j + 14 * _LANES] += u * x[q] * xy
            lanes[j + 15 * _LANES] += u * x[q] * yy
            lanes[j + 16 * _LANES] += u * y[q] * yy
            one, other = v * xx, v * yy
            lanes[j + 17 * _LANES] += one * xx * xx
            lanes[j + 18 * _LANES] += one * xx * xy
            lanes[j + 19 * _LANES] += one * xx * yy
            lanes[j + 20 * _LANES] += one * xy * yy
            lanes[j + 21 * _LANES] += other * xx * yy
            lanes[j + 22 * _LANES] += other * xy * yy
            lanes[j + 23 * _LANES] += other * yy * yy


@compiled
def _equations(lanes: Line, matrix: Floats, right: Floats) -> None:
    """Write the lower half of the normal equations' matrix, and their right side."""
    matrix[0, 0], matrix[1, 0], matrix[1, 1] = _fold(lanes, 0), _fold(lanes, 1), _fold(lanes, 2)
    right[0], right[1] = _fold(lanes, 3), _fold(lanes, 4)
    for a in range(4):
        matrix[2 + a, 0], matrix[2 + a, 1] = _fold(lanes, 5 + a), _fold(lanes, 9 + a)
        right[2 + a] = _fold(lanes, 13 + a)
    for power in range(7):
        total = _fold(lanes, 17 + power)
        for a in range(4):
            if 0 <= power - a <= a:
                matrix[2 + a, 2 + power - a] = total


@compiled
def _explained(matrix: Floats, right: Floats) -> float:
    """Chi squared that the cubic shapes explain beyond the slopes: by Cholesky, slopes first."""
    size = len(right)
    total = 0.0
    for a in range(size):
        own = matrix[a, a]
        for b in range(a):
            for c in range(b):
                matrix[a, b] -= matrix[a, c] * matrix[b, c]
            matrix[a, b] /= matrix[b, b]
            matrix[a, a] -= matrix[a, b] * matrix[a, b]
            right[a] -= matrix[a, b] * right[b]
        if not matrix[a, a] > 1e-6 * own:
            return 0.0  # too few pixels to tell shapes apart
        matrix[a, a] = math.sqrt(matrix[a, a])
        right[a] /= matrix[a, a]
        if a >= _SLOPES:
            total += right[a] * right[a]
    return total


@compiled
def skewness(  # noqa: PLR0917 - Numba takes no keyword-only ones
    boxes: NDArray[np.int64],
    s: Line,
    keep: Line,
    e: Line,
    space: Line,
    states: Floats,
    shapes: Floats,
) -> None:
    """Write to the last column of `shapes` whether the spots are skew, surely and by much.

    Zero where too many pixels are lit, or too few to tell. Column 7 is how they scatter.
    """
    matrix, right = np.empty((_TERMS, _TERMS)), np.empty(_TERMS)
    lanes = np.empty(_SUMS * _LANES, dtype=np.float32)
    for k in range(len(shapes)):
        box, shape = boxes[k], shapes[k]
        shape[-1] = 0.0
        if not np.isfinite(states[k, 4]) or box[3] * box[7] > _MOST:
            continue
        n = (box[7] * box[4] + _WHOLE - 1) // _WHOLE * _WHOLE
        p, w = 8 + (_REACH + box[6]) * box[4], space[0, :n]
        most, light = _weighted(s[k, p : p + n], keep[k, :n], e[k, :n], states[k], w, lanes)
        least = max(_SURELY * shape[7], _MUCH * light)
        if not most > 0.99 * least:
            continue
        x, y = space[1, :n], space[2, :n]
        height = box[2] - box[1]
        _places(box, 4.0 / math.sqrt(float(box[3] * box[3] + height * height)), x, y)
        _of_slopes(s[k], p, box[4], w, e[k], x, y, lanes)
        _of_cubes(s[k], p, w, e[k], x, y, lanes)
        _equations(lanes, matrix, right)
        shape[-1] = 1.0 if _explained(matrix, right) > least else 0.0
