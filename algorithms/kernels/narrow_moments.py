"""First moments of stacks of frames of 8 or 16 bits, several pixels at a time.

Frames are (N, H, W) arrays of uint8 or uint16, of at most 32768 rows and columns: the sums of a row
or a column then fit into 32 bits, of which a processor adds twice as many at once as of 64.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled

Sums = NDArray[np.int64]


@compiled
def profiles(frames: NDArray[Any], rows: Sums, columns: Sums) -> None:
    """Write the sums of each row to `rows` (N, H) and of each column to `columns` (N, W)."""
    count, height, width = frames.shape
    column = np.empty(width, np.uint32)
    for k in range(count):
        column[:] = 0
        for i in range(height):
            row = frames[k, i]
            total = np.uint32(0)
            for j in range(width):
                u = np.uint32(row[j])
                total = np.uint32(total + u)
                column[j] = np.uint32(column[j] + u)
            rows[k, i] = total
        for j in range(width):
            columns[k, j] = column[j]


@compiled
def _boxes_over(position: int, reach: int, end: int) -> tuple[int, int]:
    """Count the boxes centred in ``0..end - 1`` that hold a position; sum their centres."""
    near = max(position - reach, 0)
    far = min(position + reach, end - 1)
    boxes = far - near + 1
    return boxes, boxes * (near + far) // 2


@compiled
def _all_boxes(reach: int, end: int) -> tuple[int, int]:
    """Count the boxes that hold each position, and sum their centres, over all positions."""
    counted = 0
    summed = 0
    for position in range(end):
        boxes, centres = _boxes_over(position, reach, end)
        counted += boxes
        summed += centres
    return counted, summed


@compiled
def whole_moments(frames: NDArray[Any], reach: int, out: Sums) -> None:
    """Moments of the frames summed over a box of ``2 reach + 1`` pixels a side.

    Pixels outside the frame count as zero. `out` (N, 6) receives ``sum(B), sum(x B), sum(y B)`` of
    the box sums B, and the same of a frame that is one everywhere. A pixel enters once for each
    box that holds it; only pixels near the frame's sides are in fewer than the rest, and are
    subtracted the sums of rows and columns.
    """
    count, height, width = frames.shape
    side = 2 * reach + 1
    column = np.empty(width, np.uint32)
    columns = np.empty(width, np.int64)
    rows_of_ones, rows_y_of_ones = _all_boxes(reach, height)
    columns_of_ones, columns_x_of_ones = _all_boxes(reach, width)
    for k in range(count):
        column[:] = 0
        columns[:] = 0
        total_y: Any = 0
        for i in range(height):
            row = frames[k, i]
            light = np.uint32(0)
            for j in range(width):
                u = np.uint32(row[j])
                light = np.uint32(light + u)
                column[j] = np.uint32(column[j] + u)
            boxes, centres = _boxes_over(i, reach, height)
            across = side * np.int64(light)
            for j in range(min(reach, width)):
                across -= (side - _boxes_over(j, reach, width)[0]) * np.int64(row[j])
            for j in range(max(width - reach, reach), width):
                across -= (side - _boxes_over(j, reach, width)[0]) * np.int64(row[j])
            total_y += centres * across
            if boxes < side:
                for j in range(width):
                    columns[j] -= (side - boxes) * np.int64(row[j])
        total: Any = 0
        total_x: Any = 0
        for j in range(width):
            boxes, centres = _boxes_over(j, reach, width)
            along = columns[j] + side * np.int64(column[j])
            total += boxes * along
            total_x += centres * along
        out[k, 0] = total
        out[k, 1] = total_x
        out[k, 2] = total_y
        out[k, 3] = rows_of_ones * columns_of_ones
        out[k, 4] = rows_of_ones * columns_x_of_ones
        out[k, 5] = rows_y_of_ones * columns_of_ones


@compiled
def _above(total: int, squares: int, pixels: int, deviations: float) -> float:
    """Mean of a frame's side, from its sums, and so many standard deviations more."""
    mean = total / pixels
    return mean + deviations * math.sqrt(max(squares / pixels - mean * mean, 0.0))


@compiled
def _row_above(row: NDArray[Any], deviations: float) -> float:
    total: Any = 0
    squares: Any = 0
    for j in range(row.size):
        u = np.int64(row[j])
        total += u
        squares += u * u
    return _above(total, squares, row.size, deviations)


@compiled
def _maxima_and_dark(frame: NDArray[Any], deviations: float, maxima: NDArray[Any]) -> float:
    """Write each row's largest value to `maxima` (H,) and return the frame's dark level.

    Of what the four sides tell the second smallest.
    """
    height, width = frame.shape
    left: Any = 0
    left_squares: Any = 0
    right: Any = 0
    right_squares: Any = 0
    for i in range(height):
        row = frame[i]
        largest = row[0]
        for j in range(width):
            largest = max(largest, row[j])
        maxima[i] = largest
        u = np.int64(row[0])
        left += u
        left_squares += u * u
        u = np.int64(row[width - 1])
        right += u
        right_squares += u * u
    top, bottom = _row_above(frame[0], deviations), _row_above(frame[height - 1], deviations)
    least, second = min(top, bottom), max(top, bottom)
    side = _above(left, left_squares, height, deviations)
    second = min(second, max(side, least))
    least = min(least, side)
    side = _above(right, right_squares, height, deviations)
    return min(second, max(side, least))


@compiled
def dark_levels(frames: NDArray[Any], deviations: float, out: NDArray[np.float64]) -> None:
    """Write the dark level of each frame to `out` (N,)."""
    maxima = np.empty(frames.shape[1], frames.dtype)
    for k in range(frames.shape[0]):
        out[k] = _maxima_and_dark(frames[k], deviations, maxima)


@compiled
def light_above_dark(
    frames: NDArray[Any], deviations: float, levels: NDArray[np.float64], out: Sums
) -> None:
    """Sum over the pixels above each frame's dark level, and write that to `levels` (N,).

    For ``u = I - floor(level)`` and the pixels with ``u > 0``, `out` (N, 6) receives
    ``sum(u), sum(x u), sum(y u), count, sum(x), sum(y)``.
    """
    count, height, width = frames.shape
    column = np.empty(width, np.uint32)
    lit = np.empty(width, np.uint32)
    maxima = np.empty(height, frames.dtype)
    for k in range(count):
        levels[k] = _maxima_and_dark(frames[k], deviations, maxima)
        base = np.int32(math.floor(levels[k]))
        column[:] = 0
        lit[:] = 0
        total_y: Any = 0
        pixels_y: Any = 0
        for i in range(height):
            if maxima[i] > base:
                row = frames[k, i]
                light = np.uint32(0)
                for j in range(width):
                    over: Any = np.int32(row[j]) - base
                    u = np.uint32(max(over, 0))
                    light = np.uint32(light + u)
                    column[j] = np.uint32(column[j] + u)
                pixels = np.uint32(0)
                for j in range(width):
                    one = np.uint32(np.int32(row[j]) > base)
                    pixels = np.uint32(pixels + one)
                    lit[j] = np.uint32(lit[j] + one)
                total_y += i * np.int64(light)
                pixels_y += i * np.int64(pixels)
        total: Any = 0
        total_x: Any = 0
        pixels_all: Any = 0
        pixels_x: Any = 0
        for j in range(width):
            total += np.int64(column[j])
            total_x += j * np.int64(column[j])
            pixels_all += np.int64(lit[j])
            pixels_x += j * np.int64(lit[j])
        out[k, 0] = total
        out[k, 1] = total_x
        out[k, 2] = total_y
        out[k, 3] = pixels_all
        out[k, 4] = pixels_x
        out[k, 5] = pixels_y


def narrow(frames: NDArray[Any]) -> bool:
    """Whether these kernels take the frames."""
    return (
        frames.dtype.kind == "u" and frames.dtype.itemsize <= 2 and max(frames.shape[1:]) <= 2**15
    )
