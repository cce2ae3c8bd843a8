"""Leave out the pairs of pixels that depart from what the fit says of them.

The fourth stage of `mirror.registration`, which says what the arrays hold.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.mirror import taps

Line = NDArray[np.float32]

#: Rows around the core; lanes of the sums; lines end at multiples of the last.
_REACH, _LANES, _WHOLE = 7, 16, 64
_ZERO, _HALF, _ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
#: A pair is left out whose difference departs by so many deviations, this share of the slope and
#: this of the peak: at first, and when the fit is good.
_BAD, _BAD_SLOPE, _BAD_PEAK = (5.0, 4.5), (0.4, 0.05), (0.1, 0.003)
#: Squares of the share of the slope by which sharp rims depart, and of what slopes miss, over the
#: peak: little of noise is told where the first is above the noise that is there in the dark.
_SHARP, _FLOOR = 0.03**2, 0.0005**2
#: What the slopes' own noise adds to departures.
_OWN, _COMMON = taps.noise_of_slopes()
#: Variance of the mean of N neighbours' departures, over its square and times N: half of a normal
#: variable has (pi / 2 - 1), and those that share a pixel are alike by 0.224.
_UNSURE = (0.5 * np.pi - 1.0) * (1.0 + 2.0 * 0.224)
#: A pixel counts as lit above this fraction of the peak.
_CUT = np.float32(0.3)
#: Change of d, px, up to which the slopes for the last one stand.
_SAME = 0.05


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
def _polynomial(coefficients: Floats, d2: float) -> float:
    total = 0.0
    for k in range(coefficients.size):
        total = total * d2 + coefficients[coefficients.size - 1 - k]
    return total


@compiled
def _more(state: Floats) -> tuple[float, float]:
    """Variance of a pair's departure, and of neighbours', over that of the noise of their pixels.

    What predicts the departure has noise of the same pixels' means, half of it in each axis.
    """
    a, b = state[14] * state[14], state[15] * state[15]
    own = 1.0 + 0.5 * (a * _polynomial(_OWN, a) + b * _polynomial(_OWN, b))
    return own, own - 0.5 * a * _polynomial(_COMMON, a)


@compiled
def _complete(s: Line, box: Any) -> None:
    """Fill the rows below the middle by symmetry once more."""
    columns, stride, rows, height = box[3], box[4], box[6] + box[7], box[2] - box[1] + 1
    for i in range(_REACH):
        mirrored = max(height - 1 - (rows + i), 0)
        here, there = 8 + (_REACH + rows + i) * stride, 8 + (_REACH + mirrored) * stride
        for j in range(columns):
            s[here + j] = s[there + columns - 1 - j]


@compiled
def _noise(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, slack: Line, e: Line, dark: float, flat: Line, lanes: Line
) -> tuple[float, float]:
    """Variance of a pixel where the spot is lit and flat, and the light there.

    Told by neighbours' departures, which a light beside the spot hardly enters; `e` holds a number
    more.
    """
    n, steep = flat.size, np.float32(0.5 * _SHARP / (dark + _FLOOR))
    for q in range(n):
        lit = _ONE if mean[q] > _CUT else _ZERO
        kept = keep[q]
        lit *= max(_ZERO, kept)
        flat[q] = np.divide(lit, _ONE + steep * slack[q] * slack[q])
    flat[n - 1], e[n] = _ZERO, _ZERO
    for q in range(n - 1):
        flat[q] *= flat[q + 1]
    lanes[:] = _ZERO
    for k in range(0, n, _LANES):
        for j in range(_LANES):
            i = np.uint64(k) + np.uint64(j)  # what is never negative is vectorised
            lanes[j] += flat[i]
            lanes[j + _LANES] += flat[i] * mean[i]
            lanes[j + 2 * _LANES] += flat[i] * abs(e[i + np.uint64(1)] - e[i])
            lanes[j + 3 * _LANES] += flat[i] * flat[i]
    number = max(_fold(lanes, 0), 1e-30)
    light = max(_fold(lanes, 1) / number, 1e-30)
    apart = _fold(lanes, 2) / number
    # Of a normal variable, the mean size is sqrt(2 / pi) of the standard deviation; and the square
    # of a mean is larger than that of what it is the mean of.
    large = 1.0 + _UNSURE * _fold(lanes, 3) / (number * number)
    return 0.125 * np.pi * apart**2 / large, light


@compiled
def _beyond(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, e: Line, slack: Line, state: Floats, good: int, over: Line, lanes: Line
) -> float:
    """Write which pairs are beyond the limit to `over`; return how many."""
    more = 2.0 * _more(state)[0]
    noise, gain = np.float32(more * state[0]), np.float32(more * state[1])
    sigmas, share, least = (
        np.float32(_BAD[good]),
        np.float32(_BAD_SLOPE[good]),
        np.float32(_BAD_PEAK[good]),
    )
    noise, gain = noise * sigmas * sigmas, gain * sigmas * sigmas
    lanes[:] = _ZERO
    for k in range(0, over.size, _LANES):
        for j in range(_LANES):
            q = np.uint64(k) + np.uint64(j)
            beyond = max(_ZERO, abs(e[q]) - least - share * slack[q])
            far = (keep[q] > _ZERO) & (beyond * beyond > noise + gain * max(_ZERO, mean[q]))
            one = _ONE if far else _ZERO
            over[q] = one
            lanes[j] += one
    return _fold(lanes, 0)


@compiled
def _replace(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame_bad: NDArray[np.bool_], box: Any, s: Line, d: Line, keep: Line, e: Line
) -> float:
    """Replace the worse pixel of pairs marked -1 by the other one; light of those in clusters.

    The worse pixel is the one known as bad, else that farther from the mean of its neighbours.
    """
    left, top, last, columns, stride = box[0], box[1], box[2], box[3], box[4]
    first, above, rows = box[5], box[6], box[7]
    clusters = 0.0
    p = 8 + (_REACH + above) * stride
    for i in range(rows):
        for j in range(first, columns - first):
            q = i * stride + j
            if keep[q] >= _ZERO:
                continue
            beside = -1
            for a in range(max(i - 1, 0), min(i + 2, rows)):
                for b in range(max(j - 1, first), min(j + 2, columns - first)):
                    beside += keep[a * stride + b] <= _ZERO
            near = 0.25 * (s[p + q - stride] + s[p + q + stride] + s[p + q - 1] + s[p + q + 1])
            # One pixel is mean + half, its partner mean - half; the fit sets them 2 shift apart.
            mean, half = s[p + q], 0.5 * d[above * stride + q]
            shift = 0.5 * (d[above * stride + q] - e[q])
            upper_is_worse = abs(mean + half - near) > abs(mean - half - near)
            known = False
            if frame_bad.size > 0:
                upper = frame_bad[top + above + i, left + j]
                lower = frame_bad[last - above - i, left + columns - 1 - j]
                known = upper or lower
                if upper != lower:
                    upper_is_worse = upper
            if beside >= 2 and not known:
                clusters += abs(e[q])
            s[p + q] = mean - half + shift if upper_is_worse else mean + half - shift
    for q in range(keep.size):
        keep[q] = max(keep[q], _ZERO)
    return clusters


@compiled
def leave_out(  # noqa: PLR0917 - Numba takes no keyword-only ones
    todo: NDArray[np.int64],
    boxes: NDArray[np.int64],
    first: bool,
    bad: NDArray[np.bool_],
    s: Line,
    d: Line,
    keep: Line,
    e: Line,
    slack: Line,
    space: Line,
    states: Floats,
) -> int:
    """Leave out pairs of the windows `todo` and take over the noise; keep in it those not done.

    Return how many these are.
    """
    remaining = 0
    over, lanes = space[0], np.empty(4 * _LANES, dtype=np.float32)
    for k in todo:
        box, state = boxes[k], states[k]
        if not np.isfinite(state[4]):
            continue
        n = (box[7] * box[4] + _WHOLE - 1) // _WHOLE * _WHOLE
        p = 8 + (_REACH + box[6]) * box[4]
        before = state[1]
        kept = keep[k, :n]
        variance, light = _noise(
            s[k, p : p + n], kept, slack[k, :n], e[k], state[0], over[:n], lanes
        )
        state[1] = max(variance / _more(state)[1] - state[0], 0.0) / light
        number = _beyond(
            s[k, p : p + n],
            kept,
            e[k, :n],
            slack[k, :n],
            state,
            0 if first else 1,
            over[:n],
            lanes,
        )
        if number > 0.0:
            for q in range(n):
                if over[q] > _ZERO:
                    kept[q] = -_ONE
        if number > 0.0 or (first and bad.size > 0):
            state[13] += _replace(bad, box, s[k], d[k], kept, e[k])
            _complete(s[k], box)
        state[12] += number
        same = abs(state[1] - before) <= 0.5 * before + 0.02 * state[0]
        moved = max(abs(state[2] - state[14]), abs(state[3] - state[15]))
        if first or number > 0.0 or not same or moved >= _SAME:
            todo[remaining] = k
            remaining += 1
    return remaining
