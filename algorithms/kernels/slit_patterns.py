"""Where a known pattern of slits has its light on a line of pixels.

Lines are (R, L) float64. ``places`` (S,) are the spots' positions at zero shift, px, and `groups`
(S,) say which of the G shifts moves each: spots of equal slant keep their distances.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.copies import copy_row

Counts = NDArray[np.int64]

#: Light away from the pattern, as a fraction of the pattern's weakest spot, that makes it unsure.
_RIVAL = 0.5


@compiled
def _least_scores(  # noqa: PLR0917 - Numba takes no keyword-only ones
    row: Floats, places: Counts, groups: Counts, group: int, low: int, out: Floats
) -> None:
    """Write the least score of a group's spots at each shift to `out`, shift ``n - low`` at n."""
    first = True
    for i in range(places.size):
        if groups[i] == group:
            start = places[i] - low
            if first:
                copy_row(row[start : start + out.size], out)
                first = False
            else:
                for n in range(out.size):
                    out[n] = min(out[n], row[start + n])


@compiled
def _apart(places: Counts, groups: Counts, first: int, second: int, apart: float) -> bool:
    """Whether the spots of two groups at these shifts keep their distance."""
    for i in range(places.size):
        for j in range(places.size):
            gap = abs(places[i] + first - places[j] - second)
            if groups[i] == 0 and groups[j] == 1 and gap < apart:
                return False
    return True


@compiled
def _alone(  # noqa: PLR0917 - Numba takes no keyword-only ones
    row: Floats,
    floor: float,
    level: float,
    places: Counts,
    groups: Counts,
    shifts: Counts,
    clear_of: int,
) -> bool:
    """Whether no score further than `clear_of` from all spots comes near their level."""
    near = np.zeros(row.size, dtype=np.bool_)
    for i in range(places.size):
        at = places[i] + shifts[groups[i]]
        near[max(at - clear_of, 0) : at + clear_of + 1] = True
    for j in range(row.size):
        if not near[j] and row[j] - floor >= _RIVAL * (level - floor):
            return False
    return True


@compiled
def _plateau_middle(scores: Floats, first: int, plateau: int) -> float:
    """Return the middle of the equal scores from the first to `plateau` pixels after it."""
    last = first
    for n in range(first, min(first + plateau + 1, scores.size)):
        if scores[n] == scores[first]:
            last = n
    return 0.5 * (first + last)


@compiled
def _best_pair(  # noqa: PLR0917 - Numba takes no keyword-only ones
    first: Floats,
    second: Floats,
    low: Counts,
    places: Counts,
    groups: Counts,
    tangents: Floats,
    reach: float,
    apart: float,
) -> tuple[int, int]:
    """Find the indices of the largest sum that a Sun can cast; -1 where there is none.

    Index n of a group is its shift ``n - low``.
    """
    best = -1
    best_other = -1
    top = -np.inf
    bright = second.max()
    slope = tangents[1] - tangents[0]
    far = reach * abs(slope)
    widest = math.floor(reach * (1 + abs(tangents[0])))
    bottom = max(low[0] - widest, 0)
    limit = min(low[0] + widest + 1, first.size)
    if limit <= bottom:
        return best, best_other
    # Brightest first: what is darker than a pair found cannot be in a better one.
    start = bottom + np.argmax(first[bottom:limit])
    for turn in range(bottom - 1, limit):
        n = start if turn < bottom else turn
        if not first[n] + bright > top:
            continue
        shift = n - low[0]
        begin = max(math.ceil(shift - far) + low[1], 0)
        end = min(math.floor(shift + far) + low[1] + 1, second.size)
        for m in range(begin, end):
            if not first[n] + second[m] > top:
                continue
            other = m - low[1]
            if abs(shift - (other - shift) / slope * tangents[0]) > reach:
                continue
            if _apart(places, groups, shift, other, apart):
                top = first[n] + second[m]
                best = n
                best_other = m
    return best, best_other


@compiled
def box_means(lines: Floats, width: int, out: Floats) -> None:
    """Write means over `width` (odd) pixels about each; minus infinity where they leave the line.

    They are differences of a line's sums from its first pixel on.
    """
    rows, length = lines.shape
    half = width // 2
    sums = np.empty(length + 1)
    for r in range(rows):
        out[r] = -np.inf
        total = 0.0
        for n in range(length):
            sums[n] = total
            total += lines[r, n]
        sums[length] = total
        for n in range(length - width + 1):
            out[r, half + n] = (sums[n + width] - sums[n]) / width


@compiled
def match(  # noqa: PLR0917 - Numba takes no keyword-only ones
    scores: Floats,
    floors: Floats,
    places: Counts,
    groups: Counts,
    tangents: Floats,
    reach: float,
    apart: float,
    clear_of: int,
    plateau: int,
    out: Floats,
) -> None:
    """Write the shifts at which the pattern's least score is largest to `out` (R, G).

    Each group of spots has as its score at a shift the least of its spots' ones (maxi-min). With
    two groups the pair with the largest sum counts, among those that a displacement within
    `reach` on both axes explains and that leave all spots of different groups `apart`. Of equal
    scores within `plateau` pixels from the first the middle counts. NaN where the score is not
    above the floor (R,), or where light further than `clear_of` from all spots is half as bright.
    """
    rows, length = scores.shape
    kinds = tangents.size
    low = np.full(kinds, length)
    high = np.full(kinds, -length)
    for i in range(places.size):
        low[groups[i]] = min(low[groups[i]], places[i])
        high[groups[i]] = max(high[groups[i]], places[i])
    ends = length - high + low
    if ends.min() <= 0:
        out[:] = np.nan
        return
    least = np.empty((kinds, ends.max()))
    best = np.zeros(kinds, dtype=np.int64)
    for r in range(rows):
        out[r] = np.nan
        row = scores[r]
        level = np.inf
        for g in range(kinds):
            _least_scores(row, places, groups, g, low[g], least[g, : ends[g]])
        if kinds == 1:
            best[0] = np.argmax(least[0, : ends[0]])
        else:
            best[0], best[1] = _best_pair(
                least[0, : ends[0]],
                least[1, : ends[1]],
                low,
                places,
                groups,
                tangents,
                reach,
                apart,
            )
        for g in range(kinds):
            level = min(level, least[g, best[g]]) if best[g] >= 0 else -np.inf
        if level > floors[r] and _alone(
            row, floors[r], level, places, groups, best - low, clear_of
        ):
            for g in range(kinds):
                out[r, g] = _plateau_middle(least[g, : ends[g]], best[g], plateau) - low[g]
