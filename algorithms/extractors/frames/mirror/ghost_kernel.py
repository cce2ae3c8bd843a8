"""Odd light that a spot's own slopes do not explain: another light upon it.

The last stage of `mirror.registration`, which says what the arrays hold. A weaker light a
little beside a spot makes it skew. Of all odd shapes, the cubic ones times the spot's light are
what is left of that in lowest order once the slopes are fitted.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.mirror.lines_kernel import (
    FLOOR,
    HALF,
    LANES,
    ZERO,
    Line,
    core_start,
    departure_noise,
    fold,
    padded_length,
    places,
)
from algorithms.extractors.frames.mirror.records import State
from algorithms.kernels.cholesky import factor, forward
from algorithms.kernels.records import Records

#: A pixel counts as lit above this fraction of the peak.
_CUT = np.float32(0.1)
#: Slopes along both axes, and the four cubic shapes.
_SLOPES, _TERMS = 2, 6
#: Pivot over diagonal below which a shape is not determined.
_DEPENDENT = 1e-6
#: Sums of products that their normal equations need.
_SUMS = 24
#: Chi squared, of four degrees of freedom, of what is skew, over the scatter, and its share of the
#: light, squared, from both of which on there is a second light upon the spot.
_SURELY, _MUCH = 20.0, 0.0004
#: Pairs of pixels, lit or not, up to which spots are looked at: larger ones show a second light's
#: outline.
_MOST = 4000


@compiled
def _weight(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, e: Line, state: State, w: Line, lanes: Line
) -> tuple[float, float]:
    """Write what lit pairs weigh; return the weighted squares of the departures and of the light.

    No shapes explain more than all of the first.
    """
    more, _ = departure_noise(state)
    noise, gain = np.float32(more * (state.dark + FLOOR * FLOOR)), np.float32(more * state.gain)
    lanes[:] = ZERO
    for k in range(0, w.size, LANES):
        for j in range(LANES):
            q = np.uint64(k) + np.uint64(j)  # what is never negative is vectorised
            light = mean[q] if mean[q] > _CUT else ZERO
            half = HALF * keep[q] if light > ZERO else ZERO
            weight = np.divide(half, noise + gain * light)
            w[q] = weight
            lanes[j] += weight * e[q] * e[q]
            lanes[j + LANES] += weight * light * light
    return fold(lanes, 0, LANES), fold(lanes, 1, LANES)


@compiled
def _add_slope_products(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, p: int, stride: int, w: Line, e: Line, x: Line, y: Line, lanes: Line
) -> None:
    """Write weighted products of the slopes along both axes to the lanes.

    With each other (3), with the departure (2), and with the cubic shapes x^3, x^2 y, x y^2 and y^3
    times the light (4 for each axis). The core begins at `p` of `s`.
    """
    lanes[:] = ZERO
    for k in range(0, w.size, LANES):
        for j in range(LANES):
            q = np.uint64(k) + np.uint64(j)
            at = np.uint64(p) + q
            a = s[at + np.uint64(1)] - s[at - np.uint64(1)]
            b = s[at + np.uint64(stride)] - s[at - np.uint64(stride)]
            u, v = w[q] * a, w[q] * b
            lanes[j] += u * a
            lanes[j + LANES] += u * b
            lanes[j + 2 * LANES] += v * b
            lanes[j + 3 * LANES] += u * e[q]
            lanes[j + 4 * LANES] += v * e[q]
            u, v = u * s[at], v * s[at]
            xx, xy, yy = x[q] * x[q], x[q] * y[q], y[q] * y[q]
            lanes[j + 5 * LANES] += u * x[q] * xx
            lanes[j + 6 * LANES] += u * x[q] * xy
            lanes[j + 7 * LANES] += u * x[q] * yy
            lanes[j + 8 * LANES] += u * y[q] * yy
            lanes[j + 9 * LANES] += v * x[q] * xx
            lanes[j + 10 * LANES] += v * x[q] * xy
            lanes[j + 11 * LANES] += v * x[q] * yy
            lanes[j + 12 * LANES] += v * y[q] * yy


@compiled
def _add_cube_products(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, p: int, w: Line, e: Line, x: Line, y: Line, lanes: Line
) -> None:
    """Write weighted products of the cubic shapes to the lanes, after those of the slopes.

    With the departure (4), and with each other: x^6, x^5 y ... y^6 times the light's square.
    """
    for k in range(0, w.size, LANES):
        for j in range(LANES):
            q = np.uint64(k) + np.uint64(j)
            lit = s[np.uint64(p) + q]
            u = w[q] * lit
            v = u * lit
            u *= e[q]
            xx, xy, yy = x[q] * x[q], x[q] * y[q], y[q] * y[q]
            lanes[j + 13 * LANES] += u * x[q] * xx
            lanes[j + 14 * LANES] += u * x[q] * xy
            lanes[j + 15 * LANES] += u * x[q] * yy
            lanes[j + 16 * LANES] += u * y[q] * yy
            one, other = v * xx, v * yy
            lanes[j + 17 * LANES] += one * xx * xx
            lanes[j + 18 * LANES] += one * xx * xy
            lanes[j + 19 * LANES] += one * xx * yy
            lanes[j + 20 * LANES] += one * xy * yy
            lanes[j + 21 * LANES] += other * xx * yy
            lanes[j + 22 * LANES] += other * xy * yy
            lanes[j + 23 * LANES] += other * yy * yy


@compiled
def _equations(lanes: Line, matrix: Floats, right: Floats) -> None:
    """Write the lower half of the normal equations' matrix, and their right side."""
    matrix[0, 0], matrix[1, 0], matrix[1, 1] = (
        fold(lanes, 0, LANES),
        fold(lanes, 1, LANES),
        fold(lanes, 2, LANES),
    )
    right[0], right[1] = fold(lanes, 3, LANES), fold(lanes, 4, LANES)
    for a in range(4):
        matrix[2 + a, 0], matrix[2 + a, 1] = fold(lanes, 5 + a, LANES), fold(lanes, 9 + a, LANES)
        right[2 + a] = fold(lanes, 13 + a, LANES)
    for power in range(7):
        total = fold(lanes, 17 + power, LANES)
        for a in range(4):
            if 0 <= power - a <= a:
                matrix[2 + a, 2 + power - a] = total


@compiled
def _explain(matrix: Floats, right: Floats) -> float:
    """Chi squared that the cubic shapes explain beyond the slopes: by Cholesky, slopes first."""
    total = 0.0
    if factor(matrix, _DEPENDENT):  # else too few pixels to tell shapes apart
        forward(matrix, right)
        for one in right[_SLOPES:]:
            total += one * one
    return total


@compiled
def skewness(  # noqa: PLR0917 - Numba takes no keyword-only ones
    boxes: Records,
    s: Line,
    keep: Line,
    e: Line,
    space: Line,
    states: Records,
    forms: Records,
) -> None:
    """Write to `forms`, which tell how spots scatter, whether they are skew, surely and by much.

    Not where too many pixels are lit, or too few to tell.
    """
    matrix, right = np.empty((_TERMS, _TERMS)), np.empty(_TERMS)
    lanes = np.empty(_SUMS * LANES, dtype=np.float32)
    for k in range(len(forms)):
        box, form = boxes[k], forms[k]
        form.skew = False
        if not np.isfinite(states[k].xx) or box.columns * box.rows > _MOST:
            continue
        n, p = padded_length(box), core_start(box)
        w = space[0, :n]
        most, light = _weight(s[k, p : p + n], keep[k, :n], e[k, :n], states[k], w, lanes)
        least = max(_SURELY * form.scatter, _MUCH * light)
        if not most > 0.99 * least:
            continue
        x, y = space[1, :n], space[2, :n]
        height = box.last - box.top
        places(box, 4.0 / math.sqrt(float(box.columns * box.columns + height * height)), x, y)
        _add_slope_products(s[k], p, box.stride, w, e[k], x, y, lanes)
        _add_cube_products(s[k], p, w, e[k], x, y, lanes)
        _equations(lanes, matrix, right)
        form.skew = _explain(matrix, right) > least
