"""Leave out the pairs of pixels that depart from what the fit says of them.

The fourth stage of `mirror.registration`, which says what the arrays hold.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.extractors.frames.mirror.lines_kernel import (
    FLOOR,
    LANES,
    ONE,
    ZERO,
    Line,
    core_start,
    departure_noise,
    fold,
    mirror_below,
    padded_length,
)
from algorithms.extractors.frames.mirror.records import Box, State
from algorithms.kernels.records import Records

#: A pair is left out whose difference departs by so many deviations, this share of the slope and
#: this of the peak: at first, and when the fit is good.
_BAD, _BAD_SLOPE, _BAD_PEAK = (5.0, 4.5), (0.4, 0.05), (0.1, 0.003)
#: Square of the share of the slope by which sharp rims depart: little is known of noise where that
#: is above the noise that is there in the dark.
_SHARP, _FLOOR_SQUARE = 0.03**2, FLOOR**2
#: Variance of the mean of N neighbours' departures, over its square and times N: half of a normal
#: variable has (pi / 2 - 1), and those that share a pixel are alike by 0.224.
_UNSURE = (0.5 * np.pi - 1.0) * (1.0 + 2.0 * 0.224)
#: A pixel counts as lit above this fraction of the peak.
_CUT = np.float32(0.3)
#: Change of d, px, up to which the slopes for the last one stand.
_SAME = 0.05


@compiled
def _noise(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, slack: Line, e: Line, dark: float, flat: Line, lanes: Line
) -> tuple[float, float]:
    """Variance of a pixel where the spot is lit and flat, and the light there.

    Told by neighbours' departures, which a light beside the spot hardly enters; `e` holds a number
    more.
    """
    n, steep = flat.size, np.float32(0.5 * _SHARP / (dark + _FLOOR_SQUARE))
    for q in range(n):
        lit = ONE if mean[q] > _CUT else ZERO
        kept = keep[q]
        lit *= max(ZERO, kept)
        flat[q] = np.divide(lit, ONE + steep * slack[q] * slack[q])
    flat[n - 1], e[n] = ZERO, ZERO
    for q in range(n - 1):
        flat[q] *= flat[q + 1]
    lanes[:] = ZERO
    for k in range(0, n, LANES):
        for j in range(LANES):
            i = np.uint64(k) + np.uint64(j)  # what is never negative is vectorised
            lanes[j] += flat[i]
            lanes[j + LANES] += flat[i] * mean[i]
            lanes[j + 2 * LANES] += flat[i] * abs(e[i + np.uint64(1)] - e[i])
            lanes[j + 3 * LANES] += flat[i] * flat[i]
    number = max(fold(lanes, 0, LANES), 1e-30)
    light = max(fold(lanes, 1, LANES) / number, 1e-30)
    apart = fold(lanes, 2, LANES) / number
    # Of a normal variable, the mean size is sqrt(2 / pi) of the standard deviation; and the square
    # of a mean is larger than that of what it is the mean of.
    large = 1.0 + _UNSURE * fold(lanes, 3, LANES) / (number * number)
    return 0.125 * np.pi * apart**2 / large, light


@compiled
def _beyond(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, e: Line, slack: Line, state: State, good: int, over: Line, lanes: Line
) -> float:
    """Write which pairs are beyond the limit to `over`; return how many."""
    more = 2.0 * departure_noise(state)[0]
    noise, gain = np.float32(more * state.dark), np.float32(more * state.gain)
    sigmas, share, least = (
        np.float32(_BAD[good]),
        np.float32(_BAD_SLOPE[good]),
        np.float32(_BAD_PEAK[good]),
    )
    noise, gain = noise * sigmas * sigmas, gain * sigmas * sigmas
    lanes[:] = ZERO
    for k in range(0, over.size, LANES):
        for j in range(LANES):
            q = np.uint64(k) + np.uint64(j)
            beyond = max(ZERO, abs(e[q]) - least - share * slack[q])
            far = (keep[q] > ZERO) & (beyond * beyond > noise + gain * max(ZERO, mean[q]))
            one = ONE if far else ZERO
            over[q] = one
            lanes[j] += one
    return fold(lanes, 0, LANES)


@compiled
def _replace(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame_bad: NDArray[np.bool_], box: Box, s: Line, d: Line, keep: Line, e: Line
) -> float:
    """Replace the worse pixel of pairs marked -1 by the other one; light of those in clusters.

    The worse pixel is the one known as bad, else that farther from the mean of its neighbours.
    """
    left, top, last, columns, stride = box.left, box.top, box.last, box.columns, box.stride
    first, above, rows = box.first, box.above, box.rows
    clusters = 0.0
    p = core_start(box)
    for i in range(rows):
        for j in range(first, columns - first):
            q = i * stride + j
            if keep[q] >= ZERO:
                continue
            beside = -1
            for a in range(max(i - 1, 0), min(i + 2, rows)):
                for b in range(max(j - 1, first), min(j + 2, columns - first)):
                    beside += keep[a * stride + b] <= ZERO
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
        keep[q] = max(keep[q], ZERO)
    return clusters


@compiled
def leave_out(  # noqa: PLR0917 - Numba takes no keyword-only ones
    todo: NDArray[np.int64],
    boxes: Records,
    first: bool,
    bad: NDArray[np.bool_],
    s: Line,
    d: Line,
    keep: Line,
    e: Line,
    slack: Line,
    space: Line,
    states: Records,
) -> int:
    """Leave out pairs of the windows `todo` and take over the noise; keep in it those not done.

    Return how many these are.
    """
    remaining = 0
    over, lanes = space[0], np.empty(4 * LANES, dtype=np.float32)
    for k in todo:
        box, state = boxes[k], states[k]
        if not np.isfinite(state.xx):
            continue
        n, p = padded_length(box), core_start(box)
        before = state.gain
        kept = keep[k, :n]
        variance, light = _noise(
            s[k, p : p + n], kept, slack[k, :n], e[k], state.dark, over[:n], lanes
        )
        state.gain = max(variance / departure_noise(state)[1] - state.dark, 0.0) / light
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
                if over[q] > ZERO:
                    kept[q] = -ONE
        if number > 0.0 or (first and bad.size > 0):
            state.clusters += _replace(bad, box, s[k], d[k], kept, e[k])
            mirror_below(s[k], box)
        state.left_out += number
        same = abs(state.gain - before) <= 0.5 * before + 0.02 * state.dark
        moved = max(abs(state.d[0] - state.slopes_d[0]), abs(state.d[1] - state.slopes_d[1]))
        if first or number > 0.0 or not same or moved >= _SAME:
            todo[remaining] = k
            remaining += 1
    return remaining
