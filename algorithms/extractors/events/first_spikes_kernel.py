"""Positions from time-to-first-spike events: weighted means about winners, and winners alone.

Events are (N, M, 3) float64 ``[x_px, y_px, t_us]`` by time; rows of NaN after the last one.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Columns or rows of the largest array whose addresses are believed.
_LARGEST = 65_536
#: Window moves after which the last mean stands.
_MOVES = 10
#: Moves below which a mean has settled, px.
_SETTLED = 1e-9
#: Share of the weight that lines or spot must hold, else the events are not theirs.
_LEAST_SHARE = 0.5
#: Width of a round spot, px, from which on its second brightest pixel has half the light of the
#: brightest, wherever it falls on them.
_SHARED = 2.2
#: Light of a line's lit pixels is taken from this quantile of the weights.
_LIT = 0.75


@compiled
def count(events: Floats) -> NDArray[np.int64]:
    """Count each sample's events (N,); -1 where they are not as the array tells them.

    Not so are numbers that are not finite before the last event, and addresses below 0 or beyond
    any array.
    """
    count, most, _ = events.shape
    found = np.empty(count, dtype=np.int64)
    for k in range(count):
        last = 0
        for m in range(most):
            x, y, t = events[k, m, 0], events[k, m, 1], events[k, m, 2]
            if math.isnan(x) and math.isnan(y) and math.isnan(t):
                continue
            inside = 0.0 <= x < _LARGEST and 0.0 <= y < _LARGEST  # false for NaN
            if m != last or not inside or not math.isfinite(t):
                last = -1
                break
            last += 1
        found[k] = last
    return found


@compiled
def _weights(events: Floats, count: int, hot: float, rank: int, out: Floats) -> bool:
    """Write the light of one sample's pixels, the inverse of their times, to `out` (M,).

    Zero where a time is not positive or the light is more than `hot` times that of a lit pixel,
    which is the brightest after `rank` others, or the third quartile's where that is -1. False
    where no light is left.
    """
    valid = 0
    for m in range(count):
        t = events[m, 2]
        out[m] = 1.0 / t if t > 0.0 else 0.0
        valid += t > 0.0
    if valid == 0:
        return False
    ordered = np.sort(out[:count])[count - valid :]
    lit = ordered[int(_LIT * (valid - 1)) if rank < 0 else max(valid - 1 - rank, 0)]
    left = 0.0
    for m in range(count):
        if not out[m] <= hot * lit:
            out[m] = 0.0
        left += out[m]
    return left > 0.0


@compiled
def _winner(events: Floats, count: int, axis: int, weights: Floats, width: int) -> float:
    """Middle of the `width` neighbouring addresses along an axis that gather most light."""
    sums = np.zeros(int(events[:count, axis].max()) + 2 * width + 2)
    for m in range(count):
        sums[int(events[m, axis]) + width] += weights[m]
    window = 0.0
    for j in range(width):
        window += sums[j]
    best = window
    first = 0
    for j in range(width, sums.size):
        window += sums[j] - sums[j - width]
        if window > best * (1.0 + 1e-12):
            best = window
            first = j - width + 1
    return first + 0.5 * (width - 1) - width


@compiled
def _line_step(
    events: Floats, count: int, weights: Floats, centre: tuple[float, float], reach: float
) -> tuple[float, float, float]:
    """Return the moves (x, y) of two lines onto their events' mean, and the share of light near.

    NaN where a line has no events away from the other.
    """
    sums = np.zeros((2, 2))
    both = 0.0
    total = 0.0
    for m in range(count):
        w = weights[m]
        x, y = events[m, 0] - centre[0], events[m, 1] - centre[1]
        total += w
        if abs(x) <= reach and abs(y) <= reach:
            both += w
        elif abs(x) <= reach:
            sums[0, 0] += w
            sums[0, 1] += w * x
        elif abs(y) <= reach:
            sums[1, 0] += w
            sums[1, 1] += w * y
    if not (sums[0, 0] > 0.0 and sums[1, 0] > 0.0):
        return np.nan, np.nan, 0.0
    share = (both + sums[0, 0] + sums[1, 0]) / total
    return sums[0, 1] / sums[0, 0], sums[1, 1] / sums[1, 0], share


@compiled
def line_means(  # noqa: PLR0917 - Numba takes no keyword-only ones
    events: Floats,
    counts: NDArray[np.int64],
    width: float,
    reach: float,
    hot: float,
    out: Floats,
) -> None:
    """Write where a line along y and one along x are, (x, y), to `out` (N, 2).

    A line's position is the mean of the addresses across it, weighted by light, over the events
    within `reach` of it and further than that from the other line. NaN where the two hold less
    than half of the light, or one of them nothing away from the other.
    """
    weights = np.empty(events.shape[1])
    side = max(round(width), 1)
    for k in range(events.shape[0]):
        out[k, 0] = np.nan
        out[k, 1] = np.nan
        count = counts[k]
        if count < 1 or not _weights(events[k], count, hot, -1, weights):
            continue
        x = _winner(events[k], count, 0, weights, side)
        y = _winner(events[k], count, 1, weights, side)
        share = 0.0
        for _ in range(_MOVES):
            move_x, move_y, share = _line_step(events[k], count, weights, (x, y), reach)
            x += move_x
            y += move_y
            if not (abs(move_x) >= _SETTLED or abs(move_y) >= _SETTLED):
                break
        if share >= _LEAST_SHARE:
            out[k, 0] = x
            out[k, 1] = y


@compiled
def spot_means(  # noqa: PLR0917 - Numba takes no keyword-only ones
    events: Floats,
    counts: NDArray[np.int64],
    width: float,
    reach: float,
    hot: float,
    out: Floats,
) -> None:
    """Write the mean (x, y) of the events within `reach` of it on both axes to `out` (N, 2).

    NaN where these hold less than half of the light.
    """
    weights = np.empty(events.shape[1])
    # Pixels that lie in a round spot as a whole: those whose middle is half a diagonal inside its
    # rim. Half of them, as the spot narrows off the axis, tell what light a lit pixel has. A
    # narrower spot may light one pixel only, which leaves open what is hot.
    inside = max(0.5 * width - math.sqrt(0.5), 0.0)
    rank = max(int(0.5 * math.pi * inside * inside), 1) if width > _SHARED else 0
    for k in range(events.shape[0]):
        out[k, 0] = np.nan
        out[k, 1] = np.nan
        count = counts[k]
        if count < 1 or not _weights(events[k], count, hot, rank, weights):
            continue
        side = max(round(width), 1)
        x = _winner(events[k], count, 0, weights, side)
        y = _winner(events[k], count, 1, weights, side)
        share = 0.0
        for _ in range(_MOVES):
            near = 0.0
            total = 0.0
            mean_x = 0.0
            mean_y = 0.0
            for m in range(count):
                w = weights[m]
                total += w
                a = events[k, m, 0] - x
                b = events[k, m, 1] - y
                if abs(a) <= reach and abs(b) <= reach:
                    near += w
                    mean_x += w * a
                    mean_y += w * b
            share = near / total
            if not near > 0.0:
                break
            x += mean_x / near
            y += mean_y / near
            if abs(mean_x) < _SETTLED * near and abs(mean_y) < _SETTLED * near:
                break
        if share >= _LEAST_SHARE:
            out[k, 0] = x
            out[k, 1] = y


@compiled
def first_addresses(events: Floats, counts: NDArray[np.int64], winners: int, out: Floats) -> None:
    """Write the column and the row first to gather `winners` events to `out` (N, 2).

    Events at times that are not positive do not count. NaN where none gathers as many.
    """
    for k in range(events.shape[0]):
        count = counts[k]
        for axis in range(2):
            out[k, axis] = np.nan
            if count < 1:
                continue
            gathered = np.zeros(int(events[k, :count, axis].max()) + 1, dtype=np.int64)
            for m in range(count):
                if events[k, m, 2] > 0.0:
                    address = int(events[k, m, axis])
                    gathered[address] += 1
                    if gathered[address] == winners:
                        out[k, axis] = address
                        break


def as_events(values: NDArray[Any]) -> Floats:
    """Events as a contiguous, read-only float64 array: one type, one compilation."""
    events = np.require(values, dtype=np.float64, requirements=["C_CONTIGUOUS", "ALIGNED"]).view()
    events.flags.writeable = False
    return events
