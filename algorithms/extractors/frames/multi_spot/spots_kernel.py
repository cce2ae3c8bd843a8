"""Spots of a frame: connected pixels above a level, with the first moments of their light."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.records import Seen

Runs = NDArray[np.int32]
"""(R, 5) lit pixels side by side: a run of the same spot before it or itself, first column, past
the last, number of pixels, whether the frame's edge cuts it."""

#: Least pixels of a spot that the edge cuts: fewer are hot pixels.
_CUT_PIXELS = 4


@compiled
def _root(runs: Runs, run: int) -> int:
    """First run of the spot that a run belongs to, with the way there halved."""
    while runs[run, 0] != run:
        runs[run, 0] = runs[runs[run, 0], 0]
        run = runs[run, 0]
    return run


@compiled
def _add_runs(  # noqa: PLR0917 - Numba takes no keyword-only ones
    row: NDArray[Any], level: float, line: int, outermost: bool, runs: Runs, light: Floats, end: int
) -> int:
    """Append the runs of one row and their moments from index `end` on; return the new end."""
    j = 0
    while j < row.size:
        if not row[j] > level:
            j += 1
            continue
        first = j
        total = 0.0
        moment = 0.0
        while j < row.size and row[j] > level:
            u = row[j] - level
            total += u
            moment += (j - first) * u
            j += 1
        runs[end, 0] = end
        runs[end, 1] = first
        runs[end, 2] = j
        runs[end, 3] = j - first
        runs[end, 4] = outermost or first == 0 or j == row.size
        light[end, 0] = total
        light[end, 1] = moment + first * total
        light[end, 2] = line * total
        end += 1
    return end


@compiled
def _join(runs: Runs, above: int, here: int, end: int) -> None:
    """Join the runs ``here .. end - 1`` of a row to those above, ``above .. here - 1``."""
    for run in range(here, end):
        # those that end before this one begins touch none to come
        while above < here and runs[above, 2] < runs[run, 1]:
            above += 1
        other = above
        while other < here and runs[other, 1] <= runs[run, 2]:
            a = _root(runs, other)
            b = _root(runs, run)
            runs[max(a, b), 0] = min(a, b)
            other += 1


@compiled
def _keep(  # noqa: PLR0917 - Numba takes no keyword-only ones
    runs: Runs, light: Floats, end: int, least: float, most: float, spots: Floats, cuts: Floats
) -> tuple[int, int]:
    """Sum the runs of each spot and write those of right size, whole and cut; return how many.

    Of cut ones the first that there is room for; -1 whole ones where there is no room for all.
    """
    for run in range(end - 1, -1, -1):  # a root comes before all of its runs
        root = _root(runs, run)
        if root != run:
            runs[root, 3] += runs[run, 3]
            runs[root, 4] |= runs[run, 4]
            light[root] += light[run]
    found = 0
    cut = 0
    for run in range(end):
        if runs[run, 0] != run or runs[run, 3] > most:
            continue
        x = light[run, 1] / light[run, 0]
        y = light[run, 2] / light[run, 0]
        if runs[run, 4]:
            if runs[run, 3] >= _CUT_PIXELS and cut < cuts.shape[0]:
                cuts[cut, 0] = x
                cuts[cut, 1] = y
                cuts[cut, 2] = light[run, 0] / runs[run, 3]
                cut += 1
        elif runs[run, 3] >= least:
            if found == spots.shape[0]:
                return -1, cut
            spots[found, 0] = x
            spots[found, 1] = y
            spots[found, 2] = runs[run, 3]
            spots[found, 3] = light[run, 0]
            found += 1
    return found, cut


@compiled
def segment(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    maxima: NDArray[Any],
    levels: Floats,
    least: float,
    most: float,
    seen: Seen,
) -> None:
    """Write the spots of each frame, in the order their first pixels are read.

    A spot is a set of pixels above the frame's level (N,) that touch at sides or corners. Whole
    are those of `least` to `most` pixels that do not touch the frame's edge; their number is -1
    where there are more than there is room for. `maxima` (N, H) are the rows' largest values: rows
    that hold no pixel above the level are not read.
    """
    count, height, width = frames.shape
    room = height * (width // 2 + 1)  # at most every other pixel starts a run
    runs = np.empty((room, 5), dtype=np.int32)
    light = np.empty((room, 3))
    for k in range(count):
        above = 0
        here = 0
        end = 0
        for i in range(height):
            above, here = here, end
            if maxima[k, i] > levels[k]:
                outermost = i == 0 or i == height - 1
                end = _add_runs(frames[k, i], levels[k], i, outermost, runs, light, end)
                _join(runs, above, here, end)
        seen.counts[k], seen.cut_counts[k] = _keep(
            runs, light, end, least, most, seen.spots[k], seen.cuts[k]
        )
