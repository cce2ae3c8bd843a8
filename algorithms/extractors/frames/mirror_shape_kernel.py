"""Numbers that tell one point-symmetric spot from two lights and from light without symmetry.

The last stage of `algorithms.extractors.frames.registration`, which says what the arrays hold.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Line = NDArray[np.float32]

_REACH, _LANES = 7, 64
_ZERO, _HALF, _ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
#: What the slopes miss, over the peak, as the fit has it; and what a spot may depart by, squared.
_FLOOR, _LENIENT = 0.0005, np.float32(2.0 * 0.0015**2)
#: The square of the share of the slope by which sharp rims depart.
_SHARP = np.float32(0.03**2)
#: Pairs that are taken to depart as expected, beside those that are seen.
_EXPECTED = 5.0
#: The square of the share of the slope by which all rims depart, without moving the centre: left
#: out of what scatters, where so many pairs tell it from noise.
_RIMS, _TELLS = np.float32(0.005**2), 40.0
#: A pixel counts as lit above this fraction of the peak.
_CUT = np.float32(0.3)
#: Heights, over the peak, whose outlines are compared, and half of what they are blurred by.
_LOW, _HIGH, _BLUR = np.float32(0.3), np.float32(0.75), np.float32(0.1)


@compiled
def _fold(lanes: Line) -> float:
    """Sum of the lanes, halves added to halves."""
    size = lanes.size
    while size > 8:
        size //= 2
        first, second = lanes[:size], lanes[size : 2 * size]
        for j in range(size):
            first[j] += second[j]
    total = 0.0
    for j in range(size):
        total += lanes[j]
    return total


@compiled
def _outlines(s: Line, box: Any, columns: Line, sums: Floats) -> None:
    """Write area, xx, yy and xy of the pixels above three heights to `sums` (3, 4).

    Above the low and the high one, blurred, and above the high one, sharp.
    """
    stride, first, above, rows = box[4], box[5], box[6], box[7]
    width = box[3] - 2 * first
    columns[:] = _ZERO
    n = columns.size // 9
    a, a_y, a_yy = columns[:n], columns[n : 2 * n], columns[2 * n : 3 * n]
    b, b_y, b_yy = columns[3 * n : 4 * n], columns[4 * n : 5 * n], columns[5 * n : 6 * n]
    c, c_y, c_yy = columns[6 * n : 7 * n], columns[7 * n : 8 * n], columns[8 * n :]
    bottom_low, bottom_high = _LOW - _BLUR, _HIGH - _BLUR
    scale = _HALF / _BLUR
    for i in range(rows):
        y = np.float32(above + i - 0.5 * (box[2] - box[1]))
        twice = i == rows - 1 and (box[2] - box[1]) % 2 == 0
        share = _HALF if twice else _ONE
        p = 8 + (_REACH + above + i) * stride + first
        row = s[p : p + width]
        share_y, share_yy = share * y, share * y * y
        for j in range(width):
            t = (row[j] - bottom_low) * scale
            t = max(_ZERO, t)
            t = min(_ONE, t)
            a[j] += share * t
            a_y[j] += share_y * t
            a_yy[j] += share_yy * t
        for j in range(width):
            t = (row[j] - bottom_high) * scale
            t = max(_ZERO, t)
            t = min(_ONE, t)
            b[j] += share * t
            b_y[j] += share_y * t
            b_yy[j] += share_yy * t
        for j in range(width):
            t = _ONE if row[j] > _HIGH else _ZERO
            c[j] += share * t
            c_y[j] += share_y * t
            c_yy[j] += share_yy * t
    sums[:] = 0.0
    for q in range(3):
        number, ys, yys = (
            columns[3 * q * n :],
            columns[(3 * q + 1) * n :],
            columns[3 * q * n + 2 * n :],
        )
        for j in range(width):
            x = j - 0.5 * (width - 1)
            sums[q, 0] += number[j]
            sums[q, 1] += x * x * number[j]
            sums[q, 2] += yys[j]
            sums[q, 3] += x * ys[j]


@compiled
def _tensor(sums: Floats) -> tuple[float, float, float]:
    """Second moments xx, yy, xy over the area, a pixel's own among them."""
    n = max(sums[0], 1e-30)
    return sums[1] / n + 1.0 / 12.0, sums[2] / n + 1.0 / 12.0, sums[3] / n


@compiled
def _axes(low: tuple[float, float, float], high: tuple[float, float, float]) -> tuple[float, float]:
    """Squared extents of the high outline over the low one's, along two conjugate directions."""
    a, b, c = low
    d, e, f = high
    determinant = max(a * b - c * c, 1e-30)
    trace = (b * d + a * e - 2.0 * c * f) / determinant
    product = (d * e - f * f) / determinant
    root = math.sqrt(max(0.25 * trace * trace - product, 0.0))
    return 0.5 * trace + root, max(0.5 * trace - root, 0.0)


@compiled
def _products(a: Line, b: Line, lanes: Line) -> float:
    """Sum of products; lines are a multiple of the lanes long."""
    lanes[:] = _ZERO
    for k in range(0, a.size, _LANES):
        u, v = a[k : k + _LANES], b[k : k + _LANES]
        for j in range(_LANES):
            lanes[j] += u[j] * v[j]
    return _fold(lanes)


@compiled
def _alike(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, e: Line, stride: int, own: Line, line: Line, lanes: Line
) -> tuple[float, float]:
    """Return what neighbours miss alike, over the square of the light; sum of the light."""
    n = e.size
    own[n : n + stride + 1] = _ZERO
    for q in range(n):
        lit = _ONE if mean[q] > _CUT else _ZERO
        line[q] = lit * keep[q]
    for q in range(n):
        own[q] = line[q] * e[q]
    number = _products(line, line, lanes)
    for q in range(n):
        line[q] *= mean[q]
    squares = _products(line, mean, lanes)
    light = _products(keep, mean, lanes)
    noise = _products(own[:n], own[:n], lanes)
    across = _products(own[:n], own[1 : n + 1], lanes)
    along = _products(own[:n], own[stride : n + stride], lanes)
    chance = 5.0 * noise / math.sqrt(max(number, 1.0))
    return (max(across, along) - chance) / max(squares, 1e-30), light


@compiled
def _scatter(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, e: Line, slack: Line, state: Floats, z: Line, q: Line, lanes: Line
) -> tuple[float, float]:
    """Mean square of the departures over their variance, by the information of each pair.

    As if some more pairs had been as expected: few pairs tell little. The second allows for what
    a rim sharper than a pixel resolves departs by.
    """
    noise, gain = np.float32(2.0 * (state[0] + _FLOOR * _FLOOR)), np.float32(2.0 * state[1])
    for j in range(e.size):
        lit = mean[j]
        lit = max(_ZERO, lit)
        q[j] = np.divide(keep[j] * slack[j] * slack[j], noise + gain * lit)
    total, squares = _products(q, keep, lanes), _products(q, q, lanes)
    number = total * total / max(squares, 1e-30)
    rims = _RIMS if number >= _TELLS else _ZERO
    for j in range(e.size):
        variance = noise + gain * max(_ZERO, mean[j]) + rims * slack[j] * slack[j]
        z[j] = np.divide(e[j] * e[j], variance)
    departing = _products(q, z, lanes) / max(total, 1e-30)
    all_of_it = (number * departing + _EXPECTED) / (max(number - 2.0, 0.0) + _EXPECTED)
    for j in range(e.size):
        variance = noise + gain * max(_ZERO, mean[j]) + _LENIENT + _SHARP * slack[j] * slack[j]
        z[j] = np.divide(e[j] * e[j], variance)
    departing = _products(q, z, lanes) / max(total, 1e-30)
    return all_of_it, (number * departing + _EXPECTED) / (max(number - 2.0, 0.0) + _EXPECTED)


@compiled
def shapes(  # noqa: PLR0917 - Numba takes no keyword-only ones
    todo: NDArray[np.int64],
    boxes: NDArray[np.int64],
    s: Line,
    keep: Line,
    e: Line,
    slack: Line,
    space: Line,
    states: Floats,
    out: Floats,
) -> None:
    """Write the shape of the windows `todo` to `out` (N, 13).

    Columns: light of departing clusters over all; what neighbours miss alike; larger and smaller
    ratio of the squared extents of the high outline to the low one's; smaller squared extent of
    the low outline; area of the high outline, that of an ellipse with its moments over it; mean
    square of the departures over what is expected; the two ratios for the sharp high outline; area
    of the low outline; the mean square once more, with allowance for sharp rims; larger squared
    extent of the low outline.
    """
    sums = np.empty((3, 4))
    own, line, lanes = space[0], space[1], space[2, :_LANES]
    columns = space[3:].ravel()
    for k in todo:
        box = boxes[k]
        if not np.isfinite(states[k, 4]):
            continue
        n = (box[7] * box[4] + _LANES - 1) // _LANES * _LANES
        p = 8 + (_REACH + box[6]) * box[4]
        mean, kept, left = s[k, p : p + n], keep[k, :n], e[k, :n]
        share, light = _alike(mean, kept, left, box[4], own, line[:n], lanes)
        out[k, 7], out[k, 11] = _scatter(
            mean, kept, left, slack[k, :n], states[k], own[:n], line[:n], lanes
        )
        out[k, 0] = 0.5 * states[k, 14] / max(light, 1e-30)
        out[k, 1] = share
        _outlines(s[k], box, columns[: 9 * (box[3] + 8)], sums)
        low, high, sharp = _tensor(sums[0]), _tensor(sums[1]), _tensor(sums[2])
        out[k, 2], out[k, 3] = _axes(low, high)
        out[k, 8], out[k, 9] = _axes(low, sharp)
        half_trace, det = 0.5 * (low[0] + low[1]), low[0] * low[1] - low[2] * low[2]
        root = math.sqrt(max(half_trace * half_trace - det, 0.0))
        out[k, 4], out[k, 12] = half_trace - root, half_trace + root
        out[k, 10] = 2.0 * sums[0, 0]
        area = 2.0 * sums[2, 0]
        out[k, 5] = area
        det = max(sharp[0] * sharp[1] - sharp[2] * sharp[2], 0.0)
        out[k, 6] = 4.0 * math.pi * math.sqrt(det) / max(area, 1e-30)
