"""Numbers that tell one point-symmetric spot from two lights and from light without symmetry.

The last stage of `mirror.registration`, which says what the arrays hold.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.mirror.lines_kernel import (
    FLOOR,
    HALF,
    ONE,
    ZERO,
    Line,
    core_start,
    departure_noise,
    fold,
    padded_length,
    places,
)
from algorithms.extractors.frames.mirror.records import Box, State
from algorithms.kernels.records import Records

#: Lanes of the sums: more than in other stages, as there are many of them.
_LANES = 32
#: What a spot may depart by, squared, over the peak.
_LENIENT = np.float32(2.0 * 0.0015**2)
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
def _shares(box: Box, share: Line) -> None:
    """Write how much of a pair each is: a half in a middle row, whose pairs appear twice.

    Nothing outside of the core.
    """
    stride, first, columns = box.stride, box.first, box.columns
    whole = ONE if (box.last - box.top) % 2 == 1 else HALF
    for j in range(stride):
        share[j] = ONE if first <= j < columns - first else ZERO
    for i in range(box.rows - 1, -1, -1):
        begin = np.uint64(i * stride)
        part = whole if i == box.rows - 1 else ONE
        for j in range(stride):
            share[begin + np.uint64(j)] = part * share[j]
    for j in range(box.rows * stride, share.size):
        share[j] = ZERO


@compiled
def _outlines(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, box: Box, x: Line, y: Line, share: Line, lanes: Line, sums: Floats
) -> None:
    """Write area, xx, yy and xy of the pixels above three heights to `sums` (3, 4).

    Above the low and the high one, blurred, and above the high one, sharp.
    """
    places(box, 1.0, x, y)
    _shares(box, share)
    bottom_low, bottom_high = _LOW - _BLUR, _HIGH - _BLUR
    scale = HALF / _BLUR
    lanes[:] = ZERO
    for k in range(0, x.size, _LANES):
        for j in range(_LANES):
            q = np.uint64(k) + np.uint64(j)
            xx, yy, xy = x[q] * x[q], y[q] * y[q], x[q] * y[q]
            t = (mean[q] - bottom_low) * scale
            t = max(ZERO, t)
            t = min(ONE, t) * share[q]
            lanes[j] += t
            lanes[j + _LANES] += xx * t
            lanes[j + 2 * _LANES] += yy * t
            lanes[j + 3 * _LANES] += xy * t
            t = (mean[q] - bottom_high) * scale
            t = max(ZERO, t)
            t = min(ONE, t) * share[q]
            lanes[j + 4 * _LANES] += t
            lanes[j + 5 * _LANES] += xx * t
            lanes[j + 6 * _LANES] += yy * t
            lanes[j + 7 * _LANES] += xy * t
            t = share[q] if mean[q] > _HIGH else ZERO
            lanes[j + 8 * _LANES] += t
            lanes[j + 9 * _LANES] += xx * t
            lanes[j + 10 * _LANES] += yy * t
            lanes[j + 11 * _LANES] += xy * t
    for i in range(3):
        for j in range(4):
            sums[i, j] = fold(lanes, 4 * i + j, _LANES)


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
        own[q] = ZERO
    for q in range(n):
        lit = ONE if mean[q] > _CUT else ZERO
        line[q] = lit * keep[q]
        own[q] = line[q] * e[q]
    lanes[:] = ZERO
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
        fold(lanes, 0, _LANES),
        fold(lanes, 1, _LANES),
        fold(lanes, 2, _LANES),
        fold(lanes, 3, _LANES),
    )
    across, along = fold(lanes, 4, _LANES), fold(lanes, 5, _LANES)
    chance = 5.0 * noise / math.sqrt(max(number, 1.0))
    return (max(across, along) - chance) / max(squares, 1e-30), light


@compiled
def _scatter(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, e: Line, slack: Line, state: State, z: Line, q: Line, lanes: Line
) -> tuple[float, float]:
    """Mean square of the departures over their variance, by the information of each pair.

    As if some more pairs had been as expected: few pairs tell little, and less of a variance. The
    second allows for what a rim sharper than a pixel resolves departs by.
    """
    more = 2.0 * departure_noise(state)[0]
    noise, gain = np.float32(more * (state.dark + FLOOR * FLOOR)), np.float32(more * state.gain)
    for j in range(e.size):
        z[j] = noise + gain * max(ZERO, mean[j])
        q[j] = np.divide(keep[j] * slack[j] * slack[j], z[j])
    lanes[:] = ZERO
    for k in range(0, e.size, _LANES):
        for j in range(_LANES):
            i = np.uint64(k) + np.uint64(j)
            lanes[j] += q[i] * keep[i]
            lanes[j + _LANES] += q[i] * q[i]
    total, squares = fold(lanes, 0, _LANES), fold(lanes, 1, _LANES)
    number = total * total / max(squares, 1e-30)
    rims = _RIMS if number >= _TELLS else ZERO
    lanes[:] = ZERO
    for k in range(0, e.size, _LANES):
        for j in range(_LANES):
            i = np.uint64(k) + np.uint64(j)
            square, slope = q[i] * e[i] * e[i], slack[i] * slack[i]
            lanes[j] += np.divide(square, z[i] + rims * slope)
            lanes[j + _LANES] += np.divide(square, z[i] + _LENIENT + _SHARP * slope)
    departing, leniently = fold(lanes, 0, _LANES), fold(lanes, 1, _LANES)
    scale = number / max(total, 1e-30)
    count = max(number - 2.0, 0.0) + _EXPECTED
    # a variance that is itself estimated from so many departures: that of Student's distribution
    student = count / (count - 2.0)
    departing = student * (departing * scale + _EXPECTED) / count
    return departing, (leniently * scale + _EXPECTED) / count


@compiled
def shapes(  # noqa: PLR0917 - Numba takes no keyword-only ones
    todo: NDArray[np.int64],
    boxes: Records,
    s: Line,
    keep: Line,
    e: Line,
    slack: Line,
    space: Line,
    states: Records,
    forms: Records,
) -> None:
    """Write the forms of the windows `todo`, but for whether they are skew."""
    sums = np.empty((3, 4))
    own, line, lanes = space[0], space[1], np.empty(12 * _LANES, dtype=np.float32)
    for k in todo:
        box, form = boxes[k], forms[k]
        if not np.isfinite(states[k].xx):
            continue
        n, p = padded_length(box), core_start(box)
        mean, kept, left = s[k, p : p + n], keep[k, :n], e[k, :n]
        share, light = _alike(mean, kept, left, box.stride, own, line[:n], lanes)
        form.scatter, form.lenient = _scatter(
            mean, kept, left, slack[k, :n], states[k], own[:n], line[:n], lanes
        )
        form.clusters = 0.5 * states[k].clusters / max(light, 1e-30)
        form.alike = share
        _outlines(mean, box, space[2, :n], space[3, :n], space[4, :n], lanes, sums)
        low, high, sharp = _tensor(sums[0]), _tensor(sums[1]), _tensor(sums[2])
        form.blurred[0], form.blurred[1] = _axes(low, high)
        form.sharp[0], form.sharp[1] = _axes(low, sharp)
        half_trace, det = 0.5 * (low[0] + low[1]), low[0] * low[1] - low[2] * low[2]
        root = math.sqrt(max(half_trace * half_trace - det, 0.0))
        form.minor, form.major = half_trace - root, half_trace + root
        form.base = 2.0 * sums[0, 0]
        area = 2.0 * sums[2, 0]
        form.area = area
        det = max(sharp[0] * sharp[1] - sharp[2] * sharp[2], 0.0)
        form.waist = 4.0 * math.pi * math.sqrt(det) / max(area, 1e-30)
