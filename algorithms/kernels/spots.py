"""Spots of a frame: connected pixels above a level, with the first moments of their light."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.kernels.compilation import compiled


@compiled
def _root(parent: NDArray[np.int32], run: int) -> int:
    """First run of the spot that a run belongs to, with the way there halved."""
    while parent[run] != run:
        parent[run] = parent[parent[run]]
        run = parent[run]
    return run


@compiled
def segment(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    maxima: NDArray[Any],
    levels: Floats,
    least: float,
    most: float,
    spots: Floats,
    counts: NDArray[np.int64],
) -> None:
    """Write the whole spots of each frame, in the order their first pixels are read.

    A spot is a set of pixels above the frame's level (N,) that touch at sides or corners. Kept
    are those of `least` to `most` pixels that do not touch the frame's edge: `spots` (N, S, 3)
    receives the mean x and y, weighted by the light above the level, and the number of pixels.
    `counts` (N,) is how many there are, -1 where more than S. `maxima` (N, H) are the rows'
    largest values: rows that hold no pixel above the level are not read.
    """
    count, height, width = frames.shape
    room = height * (width // 2 + 1)  # runs of lit pixels, at most every other one
    parent = np.empty(room, dtype=np.int32)
    first = np.empty(room, dtype=np.int32)
    end = np.empty(room, dtype=np.int32)
    pixels = np.empty(room, dtype=np.int32)
    cut = np.empty(room, dtype=np.bool_)
    light = np.empty(room)
    light_x = np.empty(room)
    light_y = np.empty(room)
    for k in range(count):
        level = levels[k]
        above = 0  # runs of the row above: above .. here - 1
        here = 0
        runs = 0
        for i in range(height):
            above = here
            here = runs
            if not maxima[k, i] > level:
                continue
            row = frames[k, i]
            j = 0
            while j < width:
                if not row[j] > level:
                    j += 1
                    continue
                total = 0.0
                total_x = 0.0
                start = j
                while j < width and row[j] > level:
                    u = row[j] - level
                    total += u
                    total_x += (j - start) * u
                    j += 1
                parent[runs] = runs
                first[runs] = start
                end[runs] = j
                pixels[runs] = j - start
                cut[runs] = start == 0 or j == width or i == 0 or i == height - 1
                light[runs] = total
                light_x[runs] = total_x + start * total
                light_y[runs] = i * total
                # Runs of the row above that end before this one begins touch none to come.
                while above < here and end[above] < start:
                    above += 1
                other = above
                while other < here and first[other] <= j:
                    a = _root(parent, other)
                    b = _root(parent, runs)
                    parent[max(a, b)] = min(a, b)
                    other += 1
                runs += 1
        for run in range(runs - 1, -1, -1):  # a root comes before all of its runs
            root = _root(parent, run)
            if root != run:
                pixels[root] += pixels[run]
                cut[root] |= cut[run]
                light[root] += light[run]
                light_x[root] += light_x[run]
                light_y[root] += light_y[run]
        found = 0
        for run in range(runs):
            if parent[run] != run or cut[run] or not least <= pixels[run] <= most:
                continue
            if found == spots.shape[1]:
                found = -1
                break
            spots[k, found, 0] = light_x[run] / light[run]
            spots[k, found, 1] = light_y[run] / light[run]
            spots[k, found, 2] = pixels[run]
            found += 1
        counts[k] = found
