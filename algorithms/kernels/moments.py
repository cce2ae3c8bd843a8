"""Sums over stacks of frames: maxima, profiles and first moments, one pass each.

Frames are (N, H, W) arrays from `algorithms.inputs.as_frames`. ``zero`` sets the type of every
sum: ``np.int64(0)`` for integer frames, whose sums are then exact, ``np.float64(0)`` for the
rest. Windows are half-open ``(first row, end row, first column, end column)``, one a frame.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels import narrow_moments

Sums = NDArray[Any]
Windows = NDArray[np.int64]


@compiled
def _whole_row_maxima(frames: NDArray[Any], out: NDArray[Any]) -> None:
    """Write each row's largest integer to `out` (N, H): many at a time."""
    count, height, width = frames.shape
    for k in range(count):
        for i in range(height):
            row = frames[k, i]
            largest = row[0]
            for j in range(width):
                largest = max(largest, row[j])
            out[k, i] = largest


@compiled
def _real_row_maxima(frames: NDArray[Any], out: NDArray[Any]) -> None:
    """Write each row's largest value to `out` (N, H); meaningless where a frame is unusable."""
    count, height, width = frames.shape
    whole = width - width % 4
    for k in range(count):
        for i in range(height):
            row = frames[k, i]
            # Four maxima side by side: one alone waits for itself at every pixel.
            a = row[0]
            b = a
            c = a
            d = a
            for j in range(0, whole, 4):
                a = max(a, row[j])
                b = max(b, row[j + 1])
                c = max(c, row[j + 2])
                d = max(d, row[j + 3])
            for j in range(whole, width):
                a = max(a, row[j])
            out[k, i] = max(a, b, c, d)


@compiled
def _mark_unusable(frames: NDArray[Any], real: bool, out: NDArray[np.bool_]) -> None:
    """Mark in `out` (N,) the frames without any contrast, and those with NaN or infinity."""
    count, height, width = frames.shape
    for k in range(count):
        flat = True
        first = frames[k, 0, 0]
        for i in range(height):
            for j in range(width):
                if frames[k, i, j] != first:
                    flat = False
                    break
            if not flat:
                break
        broken = 0
        if real:
            for i in range(height):
                for j in range(width):
                    broken |= not np.isfinite(frames[k, i, j])
        out[k] = flat or broken != 0


@compiled
def _side(values: NDArray[Any], deviations: float) -> float:
    """Mean of a frame's side and so many standard deviations more."""
    first = float(values[0])
    total = 0.0
    squares = 0.0
    for j in range(values.size):
        more = float(values[j]) - first
        total += more
        squares += more * more
    mean = total / values.size
    return first + mean + deviations * math.sqrt(max(squares / values.size - mean * mean, 0.0))


@compiled
def _dark_levels(frames: NDArray[Any], deviations: float, out: Floats) -> None:
    levels = np.empty(4)
    for k in range(frames.shape[0]):
        frame = frames[k]
        levels[0] = _side(frame[0], deviations)
        levels[1] = _side(frame[-1], deviations)
        levels[2] = _side(frame[:, 0], deviations)
        levels[3] = _side(frame[:, -1], deviations)
        levels.sort()
        out[k] = levels[1]


@compiled
def moments_above(
    frames: NDArray[Any],
    maxima: NDArray[Any],
    level: Sums,
    windows: Windows,
    out: Sums,
) -> None:
    """Sum over the pixels of a window above a level, reading only rows that hold one.

    For ``u = I - level`` and the pixels with ``u > 0``, `out` (N, 6) receives
    ``sum(u), sum(x u), sum(y u), count, sum(x), sum(y)``.
    """
    zero = level[0] - level[0]  # of the levels' type, which is that of the sums
    for k in range(frames.shape[0]):
        base = level[k]
        total = zero
        total_x = zero
        total_y = zero
        pixels = zero
        pixels_x = zero
        pixels_y = zero
        top, bottom, left, right = windows[k]
        for i in range(top, bottom):
            if not maxima[k, i] > base:
                continue
            row = frames[k, i, left:right]
            row_total = zero
            row_pixels = zero
            for j in range(row.size):
                u = row[j] - base
                if u > 0:
                    row_total += u
                    row_pixels += 1
                    total_x += j * u
                    pixels_x += j
            total += row_total
            pixels += row_pixels
            total_y += i * row_total
            pixels_y += i * row_pixels
        total_x += left * total
        pixels_x += left * pixels
        out[k, 0] = total
        out[k, 1] = total_x
        out[k, 2] = total_y
        out[k, 3] = pixels
        out[k, 4] = pixels_x
        out[k, 5] = pixels_y


@compiled
def _row_sum(row: NDArray[Any], zero: Any) -> Any:
    """Sum of a row, in four sums side by side: one alone waits for itself at every pixel."""
    whole = row.size - row.size % 4
    a = zero
    b = zero
    c = zero
    d = zero
    for j in range(0, whole, 4):
        a += row[j]
        b += row[j + 1]
        c += row[j + 2]
        d += row[j + 3]
    for j in range(whole, row.size):
        a += row[j]
    return (a + b) + (c + d)


@compiled
def _boxes_over(position: int, reach: int, first: int, end: int) -> tuple[int, int]:
    """Count the boxes centred in ``first..end - 1`` that hold a position; sum their centres."""
    near = max(position - reach, first)
    far = min(position + reach, end - 1)
    boxes = far - near + 1
    return boxes, boxes * (near + far) // 2


@compiled
def box_moments(frames: NDArray[Any], windows: Windows, reach: int, zero: Any, out: Sums) -> None:
    """Moments over a window of the frames summed over a box of ``2 reach + 1`` pixels a side.

    Pixels outside the frame count as zero. The box sum is never formed: a pixel enters the sums
    once for each box of the window that holds it, and those boxes are a number of rows times a
    number of columns. `out` (N, 6) receives ``sum(B), sum(x B), sum(y B)`` of the box sums B, and
    the same three sums of a frame that is one everywhere.
    """
    count, height, width = frames.shape
    side = 2 * reach + 1
    boxes = np.zeros(width, out.dtype)  # boxes of the window that hold a column
    boxes_x = np.zeros(width, out.dtype)  # the sum of their centres' x
    column = np.zeros(width, out.dtype)
    for k in range(count):
        top, bottom, left, right = windows[k]
        low = max(left - reach, 0)
        # Slices and counts from zero: with an index that might be negative no loop vectorises.
        span = min(right + reach, width) - low
        columns = zero
        columns_x = zero
        for j in range(span):
            boxes[j], boxes_x[j] = _boxes_over(low + j, reach, left, right)
            column[j] = 0
            columns += boxes[j]
            columns_x += boxes_x[j]
        rows = zero
        rows_y = zero
        total_y = zero
        for i in range(max(top - reach, 0), min(bottom + reach, height)):
            across, across_y = _boxes_over(i, reach, top, bottom)
            rows += across
            rows_y += across_y
            row = frames[k, i, low : low + span]
            light = side * _row_sum(row, zero)
            # Only columns near the window's sides are held by fewer boxes than the rest.
            for j in range(min(2 * reach, span)):
                light -= (side - boxes[j]) * row[j]
            for j in range(max(span - 2 * reach, 2 * reach), span):
                light -= (side - boxes[j]) * row[j]
            total_y += across_y * light
            if across == 1:
                for j in range(span):
                    column[j] += row[j]
            else:
                for j in range(span):
                    column[j] += across * row[j]
        total = zero
        total_x = zero
        for j in range(span):
            total += boxes[j] * column[j]
            total_x += boxes_x[j] * column[j]
        out[k, 0] = total
        out[k, 1] = total_x
        out[k, 2] = total_y
        out[k, 3] = rows * columns
        out[k, 4] = rows * columns_x
        out[k, 5] = rows_y * columns


@compiled
def _wide_profiles(frames: NDArray[Any], zero: Any, rows: Sums, columns: Sums) -> None:
    """Write the sums of each row to `rows` (N, H) and of each column to `columns` (N, W)."""
    count, height, width = frames.shape
    for k in range(count):
        column = columns[k]
        column[:] = zero
        for i in range(height):
            row = frames[k, i]
            total = zero
            for j in range(width):
                total += row[j]
                column[j] += row[j]
            rows[k, i] = total


def row_maxima(frames: NDArray[Any], out: NDArray[Any]) -> None:
    """Write each row's largest value to `out` (N, H); meaningless where a frame is unusable."""
    if frames.dtype.kind == "f":
        _real_row_maxima(frames, out)
    else:
        _whole_row_maxima(frames, out)


def dark_levels(frames: NDArray[Any], deviations: float) -> Floats:
    """Return what dark pixels of each frame stay below (N,).

    Each of the frame's four sides tells a mean and a standard deviation; the second smallest of
    the four levels ``mean + deviations s`` counts, so that light or a hot pixel on one or two
    sides does not raise it.
    """
    levels = np.empty(len(frames))
    if narrow_moments.narrow(frames):
        narrow_moments.dark_levels(frames, deviations, levels)
    else:
        _dark_levels(frames, deviations, levels)
    return levels


def axis_sums(frames: NDArray[Any]) -> tuple[Sums, Sums]:
    """Return the sums of each column (N, W) and of each row (N, H)."""
    (count, height, width), zero = frames.shape, zero_of(frames)
    columns, rows = np.empty((count, width), zero.dtype), np.empty((count, height), zero.dtype)
    if narrow_moments.narrow(frames):
        narrow_moments.profiles(frames, rows, columns)
    else:
        _wide_profiles(frames, zero, rows, columns)
    return columns, rows


def unusable_frames(frames: NDArray[Any]) -> NDArray[np.bool_]:
    """Say which frames (N,) are without any contrast, or hold a NaN or infinity."""
    found = np.empty(len(frames), dtype=np.bool_)
    _mark_unusable(frames, frames.dtype.kind == "f", found)
    return found


def zero_of(frames: NDArray[Any]) -> Any:
    """Return the zero whose type the sums over `frames` take: int64 for integers, else float64."""
    return np.int64(0) if frames.dtype.kind in "ui" else np.float64(0.0)


def whole_frame(frames: NDArray[Any]) -> Windows:
    """Return the windows (N, 4) that cover every frame."""
    count, height, width = frames.shape
    return np.tile(np.array([0, height, 0, width], dtype=np.int64), (count, 1))


def first_brightest(frames: NDArray[Any], maxima: NDArray[Any]) -> Floats:
    """Pixel (x, y) of each frame's largest value, the first in reading order of several."""
    index = np.arange(len(frames))
    y = np.argmax(maxima, axis=1)
    x = np.argmax(frames[index, y], axis=1)
    return np.column_stack([x, y]).astype(np.float64)
