"""Connected regions of pixels: flooded from one of them, or runs of rows joined where they touch.

Runs are records, in the order that they are read, with the fields ``parent`` (an earlier run of the
same region, or the run itself), ``first`` and ``end`` (its first column and that past its last).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.kernels.records import Records

#: Steps (rows, columns) to the pixels that touch one: at its sides, and at its corners too.
SIDES = np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])
SIDES_AND_CORNERS = np.array([[-1, -1], [-1, 0], [-1, 1], [0, -1], [0, 1], [1, -1], [1, 0], [1, 1]])


@compiled
def flood(  # noqa: PLR0917 - Numba takes no keyword-only ones
    image: NDArray[Any],
    start: int,
    level: float,
    above: bool,
    steps: NDArray[np.int64],
    most: int,
    mark: int,
    marks: NDArray[Any],
    pixels: NDArray[np.int64],
) -> tuple[int, bool]:
    """List the pixels that hang together with one, itself included.

    Parameters
    ----------
    image, start
        (H, W); the first pixel, as row times width plus column.
    level, above
        Pixels are those above the level, or those that are not above it.
    steps
        To the neighbours that hang together with a pixel: `SIDES` or `SIDES_AND_CORNERS`.
    most
        Number of pixels above which none count.
    mark, marks
        (H W,) receives the mark, which no pixel has yet, where a pixel is listed.
    pixels
        (at least `most`,) receives them, in the order they are met.

    Returns
    -------
    int, bool
        How many there are, 0 for more than `most`; whether none of them is at the image's edge.
    """
    height, width = image.shape
    pixels[0] = start
    marks[start] = mark
    count = 1
    done = 0
    enclosed = True
    while done < count:
        row, column = pixels[done] // width, pixels[done] % width
        done += 1
        for n in range(steps.shape[0]):
            i, j = row + steps[n, 0], column + steps[n, 1]
            if i < 0 or j < 0 or i >= height or j >= width:
                enclosed = False
                continue
            at = i * width + j
            if marks[at] != mark and (image[i, j] > level) == above:
                if count == most:
                    return 0, False
                marks[at] = mark
                pixels[count] = at
                count += 1
    return count, enclosed


@compiled
def root_of(runs: Records, run: int) -> int:
    """First run of the region that a run belongs to, with the way there halved."""
    while runs[run].parent != run:
        runs[run].parent = runs[runs[run].parent].parent
        run = runs[run].parent
    return run


@compiled
def join_runs(runs: Records, above: int, here: int, end: int) -> int:
    """Join the runs ``here .. end - 1`` of a row to those above, ``above .. here - 1``.

    Runs touch at sides or corners. Return how many of the row touch none above.
    """
    alone = 0
    for run in range(here, end):
        # those that end before this one begins touch none to come
        while above < here and runs[above].end < runs[run].first:
            above += 1
        other = above
        while other < here and runs[other].first <= runs[run].end:
            a = root_of(runs, other)
            b = root_of(runs, run)
            runs[max(a, b)].parent = min(a, b)
            other += 1
        alone += runs[run].parent == run
    return alone
