"""Spots of a frame: connected pixels above a level, with the first moments of their light."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.records import Seen
from algorithms.kernels.records import Records, record
from algorithms.kernels.regions import join_runs, root_of

#: Least pixels of a spot that the edge cuts: fewer are hot pixels.
_CUT_PIXELS = 4


class Run:
    """Lit pixels side by side, and sums over them or, where it is the first, over their spot.

    Attributes
    ----------
    parent, first, end
        See `algorithms.kernels.regions`.
    pixels, cut
        Number of pixels; whether the frame's edge cuts it.
    light, x, y
        Light above the level, and that times the place.
    """

    parent: int
    first: int
    end: int
    pixels: int
    cut: bool
    light: float
    x: float
    y: float


_RUN = record(Run)


@compiled
def _add_runs(  # noqa: PLR0917 - Numba takes no keyword-only ones
    row: NDArray[Any], level: float, line: int, outermost: bool, runs: Records, end: int
) -> int:
    """Append the runs of one row from index `end` on; return the new end."""
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
        run = runs[end]
        run.parent, run.first, run.end, run.pixels = end, first, j, j - first
        run.cut = outermost or first == 0 or j == row.size
        run.light, run.x, run.y = total, moment + first * total, line * total
        end += 1
    return end


@compiled
def _keep(  # noqa: PLR0917 - Numba takes no keyword-only ones
    runs: Records, end: int, least: float, most: float, spots: Floats, cuts: Floats
) -> tuple[int, int]:
    """Sum the runs of each spot and write those of right size, whole and cut; return how many.

    Of cut ones the first that there is room for; -1 whole ones where there is no room for all.
    """
    for at in range(end - 1, -1, -1):  # the first run comes before all others
        first = root_of(runs, at)
        if first != at:
            spot, run = runs[first], runs[at]
            spot.pixels += run.pixels
            spot.cut |= run.cut
            spot.light += run.light
            spot.x += run.x
            spot.y += run.y
    found = 0
    cut = 0
    for at in range(end):
        run = runs[at]
        if run.parent != at or run.pixels > most:
            continue
        if run.cut:
            if run.pixels >= _CUT_PIXELS and cut < cuts.shape[0]:
                cuts[cut, 0] = run.x / run.light
                cuts[cut, 1] = run.y / run.light
                cuts[cut, 2] = run.light / run.pixels
                cut += 1
        elif run.pixels >= least:
            if found == spots.shape[0]:
                return -1, cut
            spots[found, 0] = run.x / run.light
            spots[found, 1] = run.y / run.light
            spots[found, 2] = run.pixels
            spots[found, 3] = run.light
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
    runs = np.empty(room, dtype=_RUN)
    for k in range(count):
        above = 0
        here = 0
        end = 0
        for i in range(height):
            above, here = here, end
            if maxima[k, i] > levels[k]:
                outermost = i == 0 or i == height - 1
                end = _add_runs(frames[k, i], levels[k], i, outermost, runs, end)
                join_runs(runs, above, here, end)
        seen.counts[k], seen.cut_counts[k] = _keep(
            runs, end, least, most, seen.spots[k], seen.cuts[k]
        )
