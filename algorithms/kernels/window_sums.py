"""Square windows of frames: their sums by columns and rows, and the box around the maxima."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Counts = NDArray[np.int64]


@compiled
def boxes_of_maxima(frames: NDArray[Any], maxima: NDArray[Any], out: Counts) -> None:
    """Write the box around all pixels of a frame's largest value to `out` (N, 4).

    Columns are the first x and y, then the last; `maxima` (N, H) are the rows' largest values.
    """
    count, height, width = frames.shape
    for k in range(count):
        largest = maxima[k].max()
        left = width
        right = -1
        top = height
        bottom = -1
        for i in range(height):
            if maxima[k, i] != largest:
                continue
            top = min(top, i)
            bottom = i
            for j in range(width):
                if frames[k, i, j] == largest:
                    left = min(left, j)
                    right = max(right, j)
        out[k, 0] = left
        out[k, 1] = top
        out[k, 2] = right
        out[k, 3] = bottom


@compiled
def window_profiles(frames: NDArray[Any], centres: Counts, half: int, out: Floats) -> None:
    """Write sums over windows of ``2 half + 1`` pixels a side to `out` (N, 2, 2 half + 1).

    First the sums of each column, then of each row, about the centre (x, y) (N, 2); NaN where
    the window leaves the frame.
    """
    count, height, width = frames.shape
    for k in range(count):
        x, y = centres[k]
        if x < half or y < half or x + half >= width or y + half >= height:
            out[k] = np.nan
            continue
        out[k] = 0.0
        for i in range(2 * half + 1):
            row = frames[k, y - half + i]
            total = 0.0
            for j in range(2 * half + 1):
                u = float(row[x - half + j])
                out[k, 0, j] += u
                total += u
            out[k, 1, i] = total
