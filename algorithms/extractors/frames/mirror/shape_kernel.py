"""Numbers that tell one point-symmetric spot from two lights and from light without symmetry.

The last stage of `mirror.registration`, which says what the arrays hold.
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
_REACH, _LANES, _WHOLE = 7, 32, 64
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
#: What the slopes' own noise adds to departures.
_OWN = taps.noise_of_slopes()[0]
#: A pixel counts as lit above this fraction of the peak.
_CUT = np.float32(0.3)
#: Heights, over the peak, whose outlines are compared, and half of what they are blurred by.
_LOW, _HIGH, _BLUR = np.float32(0.3), np.float32(0.75), np.float32(0.1)


@compiled
def _fold(lanes: Line, which: int) -> float:
    """Sum of the lanes of one of several sums, halves added to halves."""
    p = which * _LANES
    for j in range(_LANES // 2):
        lanes[p + j] += lanes[p + j + _LANES // 2]
    for j in range(_LANES // 4):
        lanes[p + j] += lanes[p + j + _LANES // 4]
    a, b = float(lanes[p]) + lanes[p + 1], float(lanes[p + 2]) + lanes[p + 3]
    c, e = float(lanes[p + 4]) + lanes[p + 5], float(lanes[p + 6]) + lanes[p + 7]
    total: float = (a + b) + (c + e)
    return total


@compiled
def _places(box: Any, x: Line, y: Line, share: Line) -> None:
    """Write x and y of the core's pairs, from the middle, and how much of a pair each is.

    That is a half in a middle row, whose pairs appear twice, and nothing outside of the core.
    """
    stride, first, columns = box[4], box[5], box[3]
    whole = _ONE if (box[2] - box[1]) % 2 == 1 else _HALF
    for j in range(stride):
        x[j] = np.float32(j - 0.5 * (columns - 1))
        share[j] = _ONE if first <= j < columns - first else _ZERO
    for i in range(box[7] - 1, -1, -1):
        begin, along = np.uint64(i * stride), np.float32(box[6] + i - 0.5 * (box[2] - box[1]))
        part = whole if i == box[7] - 1 else _ONE
        for j in range(stride):
            q = begin + np.uint64(j)
            x[q] = x[j]
            y[q] = along
            share[q] = part * share[j]
    for j in range(box[7] * stride, x.size):
        x[j], y[j], share[j] = _ZERO, _ZERO, _ZERO


@compiled
def _outlines(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, box: Any, x: Line, y: Line, share: Line, lanes: Line, sums: Floats
) -> None:
    """Write area, xx, yy and xy of the pixels above three heights to `sums` (3, 4).

    Above the low and the high one, blurred, and above the high one, sharp.
    """
    _places(box, x, y, share)
    bottom_low, bottom_high = _LOW - _BLUR, _HIGH - _BLUR
    scale = _HALF / _BLUR
    lanes[:] = _ZERO
    for k in range(0, x.size, _LANES):
        for j in range(_LANES):
            q = np.uint64(k) + np.uint64(j)
            xx, yy, xy = x[q] * x[q], y[q] * y[q], x[q] * y[q]
            t = (mean[q] - bottom_low) * scale
            t = max(_ZERO, t)
            t = min(_ONE, t) * share[q]
            lanes[j] += t
            lanes[j + _LANES] += xx * t
            lanes[j + 2 * _LANES] += yy * t
            lanes[j + 3 * _LANES] += xy * t
            t = (mean[q] - bottom_high) * scale
            t = max(_ZERO, t)
            t = min(_ONE, t) * share[q]
            lanes[j + 4 * _LANES] += t
            lanes[j + 5 * _LANES] += xx * t
            lanes[j + 6 * _LANES] += yy * t
            lanes[j + 7 * _LANES] += xy * t
            t = share[q] if mean[q] > _HIGH else _ZERO
            lanes[j + 8 * _LANES] += t
            lanes[j + 9 * _LANES] += xx * t
            lanes[j + 10 * _LANES] += yy * t
            lanes[j + 11 * _LANES] += xy * t
    for i in range(3):
        for j in range(4):
            sums[i, j] = _fold(lanes, 4 * i + j)


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
def _alike(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, e: Line, stride: int, own: Line, line: Line, lanes: Line
) -> tuple[float, float]:
    """Return what neighbours miss alike, over the square of the light; sum of the light."""
    n = e.size
    for q in range(n, n + stride + 1):
        own[q] = _ZERO
    for q in range(n):
        lit = _ONE if mean[q] > _CUT else _ZERO
        line[q] = lit * keep[q]
        own[q] = line[q] * e[q]
    lanes[:] = _ZERO
    for k in range(0, n, _LANES):
        for j in range(_LANES):
            i = np.uint64(k) + np.uint64(j)  # what is never negative is vectorised
            lanes[j] += line[i] * line[i]
            lanes[j + _LANES] += line[i] * mean[i] * mean[i]
            lanes[j + 2 * _LANES] += keep[i] * mean[i]
            lanes[j + 3 * _LANES] += own[i] * own[i]
            lanes[j + 4 * _LANES] += own[i] * own[i + np.uint64(1)]
            lanes[j + 5 * _LANES] += own[i] * own[i + np.uint64(stride)]
    number, squares, light, noise = (
        _fold(lanes, 0),
        _fold(lanes, 1),
        _fold(lanes, 2),
        _fold(lanes, 3),
    )
    across, along = _fold(lanes, 4), _fold(lanes, 5)
    chance = 5.0 * noise / math.sqrt(max(number, 1.0))
    return (max(across, along) - chance) / max(squares, 1e-30), light


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
def _scatter(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, e: Line, slack: Line, state: Floats, z: Line, q: Line, lanes: Line
) -> tuple[float, float]:
    """Mean square of the departures over their variance, by the information of each pair.

    As if some more pairs had been as expected: few pairs tell little, and less of a variance. The
    second allows for what a rim sharper than a pixel resolves departs by.
    """
    more = 2.0 * _more(state)
    noise, gain = np.float32(more * (state[0] + _FLOOR * _FLOOR)), np.float32(more * state[1])
    for j in range(e.size):
        z[j] = noise + gain * max(_ZERO, mean[j])
        q[j] = np.divide(keep[j] * slack[j] * slack[j], z[j])
    lanes[:] = _ZERO
    for k in range(0, e.size, _LANES):
        for j in range(_LANES):
            i = np.uint64(k) + np.uint64(j)
            lanes[j] += q[i] * keep[i]
            lanes[j + _LANES] += q[i] * q[i]
    total, squares = _fold(lanes, 0), _fold(lanes, 1)
    number = total * total / max(squares, 1e-30)
    rims = _RIMS if number >= _TELLS else _ZERO
    lanes[:] = _ZERO
    for k in range(0, e.size, _LANES):
        for j in range(_LANES):
            i = np.uint64(k) + np.uint64(j)
            square, slope = q[i] * e[i] * e[i], slack[i] * slack[i]
            lanes[j] += np.divide(square, z[i] + rims * slope)
            lanes[j + _LANES] += np.divide(square, z[i] + _LENIENT + _SHARP * slope)
    departing, leniently = _fold(lanes, 0), _fold(lanes, 1)
    scale = number / max(total, 1e-30)
    count = max(number - 2.0, 0.0) + _EXPECTED
    # a variance that is itself told by so many departures: that of Student's distribution
    student = count / (count - 2.0)
    departing = student * (departing * scale + _EXPECTED) / count
    return departing, (leniently * scale + _EXPECTED) / count


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
    own, line, lanes = space[0], space[1], np.empty(12 * _LANES, dtype=np.float32)
    for k in todo:
        box = boxes[k]
        if not np.isfinite(states[k, 4]):
            continue
        n = (box[7] * box[4] + _WHOLE - 1) // _WHOLE * _WHOLE
        p = 8 + (_REACH + box[6]) * box[4]
        mean, kept, left = s[k, p : p + n], keep[k, :n], e[k, :n]
        share, light = _alike(mean, kept, left, box[4], own, line[:n], lanes)
        out[k, 7], out[k, 11] = _scatter(
            mean, kept, left, slack[k, :n], states[k], own[:n], line[:n], lanes
        )
        out[k, 0] = 0.5 * states[k, 13] / max(light, 1e-30)
        out[k, 1] = share
        _outlines(mean, box, space[2, :n], space[3, :n], space[4, :n], lanes, sums)
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
