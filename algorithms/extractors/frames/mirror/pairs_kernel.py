"""Pair the pixels of a window about the middle of a spot: their means and differences.

The first stage of `mirror.registration`, which says what the arrays hold.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.extractors.frames.mirror.lines_kernel import (
    HALF,
    ONE,
    REACH,
    WHOLE,
    ZERO,
    Line,
    mirror_below,
    padded_length,
)
from algorithms.extractors.frames.mirror.records import Box, Light
from algorithms.kernels.records import Records

#: Half the core, px: the lit extent times one and a bit, more where the light falls off slowly.
_WIDER, _SOFTER, _MARGIN = 1.1, 1.5, 2.0
#: The ring about the core that tells the background's slope, over the core.
_RING_SHARE = 0.25
#: As much as this, over the peak, a pixel counts at most.
_MOST = np.float32(4.0)
#: In the ring, a pair that differs by this share of the peak and so many deviations is cleaned.
_RING_BAD, _BAD = 0.1, 5.0


@compiled
def _halves(light: Light) -> tuple[float, float, float, float]:
    """Half the core along x and y, and how far the ring around it goes beyond, px."""
    wider = _WIDER + _SOFTER * (1.0 - min(max(light.fill, 0.5), 1.0))
    half_x, half_y = wider * light.half[0] + _MARGIN, wider * light.half[1] + _MARGIN
    return half_x, half_y, max(REACH, _RING_SHARE * half_x), max(REACH, _RING_SHARE * half_y)


@compiled
def begin(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lights: Records,
    height: int,
    width: int,
    middles: NDArray[np.int64],
    states: Records,
    out: NDArray[np.int64],
) -> None:
    """Write where the spots are taken to be, and how large their windows may get.

    To `out` (3,) go the most numbers that a line of any window takes, and one of its core; then
    those of all windows, in two lines of the first kind and three of the second.
    """
    for k in range(len(lights)):
        for axis in range(2):
            middles[k, axis] = round(2.0 * lights[k].middle[axis])
            states[k].d[axis] = 2.0 * lights[k].middle[axis] - middles[k, axis]
        states[k].dark = lights[k].noise / lights[k].peak ** 2
    out[:] = 0
    for light in lights:
        half_x, half_y, ring_x, ring_y = _halves(light)
        across = min(2.0 * (half_x + ring_x) + 2.0, width + 7.0) + 7.0
        along = min(half_y + ring_y + 2.0, 0.5 * height + 1.0) + 2.0 * REACH
        window = int(across * along) + 4 * WHOLE
        core = int(across * min(half_y + 3.0, along)) + 4 * WHOLE
        out[0], out[1] = max(out[0], window), max(out[1], core)
        out[2] += 2 * window + 3 * core


@compiled
def _window(light: Light, middle: NDArray[np.int64], height: int, width: int, box: Box) -> bool:
    """Write where the window and its core lie to `box`; False where the edge cuts the core."""
    wide, high = light.half
    m_x, m_y = middle
    half_x, half_y, ring_x, ring_y = _halves(light)
    left = max(math.ceil(0.5 * m_x - half_x - ring_x), 0, m_x - (width - 1))
    top = max(math.ceil(0.5 * m_y - half_y - ring_y), 0, m_y - (height - 1))
    columns, last = m_x - 2 * left + 1, m_y - top
    if columns < 2.0 * wide + 2.0 or last - top < 2.0 * high + 1.0:
        return False
    first = max(math.ceil(0.5 * m_x - half_x) - left, 0)
    above = max(math.ceil(0.5 * m_y - half_y) - top, 0)
    # Rows share the columns between them, so that those of the core reach no other one's.
    stride = columns + max(REACH - first, 0)
    box.left, box.top, box.last, box.columns = left, top, last, columns
    box.stride, box.first, box.above = stride, first, above
    box.rows = (last - top + 2) // 2 - above
    return True


# Arrays are cut inside of loops where nothing else is done: elsewhere each cut counts references.


@compiled
def _scale(  # noqa: PLR0917 - Numba takes no keyword-only ones
    pixels: NDArray[Any],
    begin: int,
    step: int,
    rows: int,
    base: float,
    scale: float,
    out: Line,
    stride: int,
) -> None:
    """Write light over the peak, at most `_MOST`, of pixels in rows `step` apart from `begin` on.

    Rows of `out` are full: what comes after the end of a window's row is read, too.
    """
    for i in range(rows):
        part = pixels[begin + i * step : begin + i * step + stride]
        line = out[i * stride : i * stride + part.size]
        for j in range(part.size):
            a = np.float32((part[j] - base) * scale)
            line[j] = a if a < _MOST else _MOST  # noqa: FURB136 - `min` minds NaN, which costs


@compiled
def _reverse(line: Line, last: int, rows: int, stride: int, out: Line) -> None:
    """Write rows of `line` from their `last` number back; numbers ahead of the first must be."""
    for i in range(rows):
        end = np.uint64(last + i * stride)  # an index that may be negative would not be vectorised
        row = out[i * stride : (i + 1) * stride]
        for j in range(row.size):
            row[j] = line[end - np.uint64(j)]


@compiled
def _largest(d: Line, rows: int, columns: int, stride: int, out: Line) -> None:
    """Write the largest difference of each column; nothing is in columns beyond the last."""
    out[:stride] = ZERO
    for i in range(rows):
        row = d[i * stride : (i + 1) * stride]
        for j in range(row.size):
            out[j] = max(out[j], abs(row[j]))
        for j in range(columns, row.size):
            row[j] = ZERO


@compiled
def _pairs(  # noqa: PLR0917 - Numba takes no keyword-only ones
    flat: NDArray[Any],
    begin: int,
    width: int,
    box: Box,
    base: float,
    scale: float,
    work: Line,
    s: Line,
    d: Line,
    largest: Line,
) -> None:
    """Write means of pairs to `s`, its row 0 after `REACH` others and 8, and differences to `d`.

    The frame begins at `begin` of all pixels. To `largest` (2, W + `WHOLE`) go the largest
    differences of columns above the core, and from there on.
    """
    left, top, last, columns, stride = box.left, box.top, box.last, box.columns, box.stride
    rows, first = box.above + box.rows, 8 + REACH * stride
    n = rows * stride
    means, differences, lower = s[first : first + n], d[:n], work[WHOLE : WHOLE + n]
    _scale(flat, begin + top * width + left, width, rows, base, scale, means, stride)
    _scale(flat, begin + last * width + left, -width, rows, base, scale, lower, stride)
    _reverse(work, WHOLE + columns - 1, rows, stride, differences)
    for j in range(n):
        a, b = means[j], differences[j]
        means[j] = HALF * (a + b)
        differences[j] = a - b
    _largest(differences, box.above, columns, stride, largest[0])
    _largest(differences[box.above * stride :], box.rows, columns, stride, largest[1])


@compiled
def _complete(s: Line, box: Box) -> None:
    """Fill the rows below the middle by symmetry, the columns and rows around with neighbours."""
    rows, columns, stride = box.above + box.rows, box.columns, box.stride
    mirror_below(s, box)
    for i in range(REACH if stride > columns else rows + 2 * REACH, rows + 2 * REACH):
        end = 8 + i * stride + columns
        following = 8 + (min(i, rows + 2 * REACH - 2) + 1) * stride
        between = HALF * (s[end - 1] + s[following])
        for j in range(end, 8 + (i + 1) * stride):
            s[j] = between
    first = 8 + REACH * stride
    for j in range(stride):
        for i in range(REACH):
            s[8 + i * stride + j] = s[first + j]
    end = 8 + (rows + 2 * REACH) * stride
    for j in range(8):
        s[j] = s[8]
    for j in range(end, end + WHOLE + 8):
        s[j] = s[end - 1]


@compiled
def _clean_ring(s: Line, d: Line, box: Box, far: float, largest: Line) -> None:
    """Where a pair around the core differs by more than `far`, take the darker pixel for both.

    `largest` are the columns' largest differences, above the core and from there on.
    """
    columns, stride, first, above = box.columns, box.stride, box.first, box.above
    beyond = 0
    for j in range(columns):
        beyond += largest[0, j] > far
    for j in range(first):
        beyond += largest[1, j] > far
        beyond += largest[1, columns - 1 - j] > far
    if beyond == 0:
        return
    for i in range(above + box.rows):
        row, means = d[i * stride : i * stride + columns], s[8 + (i + REACH) * stride :]
        for j in range(columns):
            if abs(row[j]) > far and (i < above or j < first or j >= columns - first):
                means[j] -= HALF * abs(row[j])
                row[j] = ZERO


@compiled
def _keep(bad: NDArray[np.bool_], box: Box, keep: Line) -> None:
    """One for the core's pairs, half for those of a middle row, which appear twice; else zero.

    Minus one where `bad` (H, W; empty for none) marks either pixel.
    """
    left, top, last, columns, stride = box.left, box.top, box.last, box.columns, box.stride
    first, above, rows = box.first, box.above, box.rows
    keep[:] = ZERO
    for i in range(rows):
        keep[i * stride + first : i * stride + columns - first] = ONE
    if (last - top) % 2 == 0:
        keep[(rows - 1) * stride + first : (rows - 1) * stride + columns - first] = HALF
    if bad.size > 0:
        for i in range(rows):
            upper, lower = bad[top + above + i], bad[last - above - i]
            for j in range(first, columns - first):
                if upper[left + j] or lower[left + columns - 1 - j]:
                    keep[i * stride + j] = -ONE


@compiled
def pair_up(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    which: NDArray[np.int64],
    todo: NDArray[np.int64],
    lights: Records,
    middles: NDArray[np.int64],
    bad: NDArray[np.bool_],
    boxes: Records,
    s: Line,
    d: Line,
    keep: Line,
    space: Line,
    states: Records,
) -> None:
    """Pair up the windows `todo` of the frames `which`; 0 columns where the edge cuts the spot."""
    count, height, width = frames.shape
    flat = frames.reshape(count * height * width)
    largest, work = np.empty((2, width + WHOLE), dtype=np.float32), space.reshape(space.size)
    for k in todo:
        box, light = boxes[k], lights[k]
        box.columns = 0
        if not _window(light, middles[k], height, width, box):
            states[k].xx = np.inf
            continue
        first, scale = which[k] * height * width, 1.0 / light.peak
        _pairs(flat, first, width, box, light.base, scale, work, s[k], d[k], largest)
        end = (box.above + box.rows) * box.stride
        d[k, end : end + WHOLE] = ZERO
        far = _RING_BAD + _BAD * math.sqrt(2.0 * light.noise) / light.peak
        _clean_ring(s[k], d[k], box, far, largest)
        _complete(s[k], box)
        _keep(bad, box, keep[k, : padded_length(box)])
