"""Pair the pixels of a window about the middle of a spot: their means and differences.

The first stage of `algorithms.extractors.frames.registration`, which says what the arrays hold.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Line = NDArray[np.float32]

#: Rows and columns around the core that its slopes reach; lines end so much later.
REACH, LANES = 7, 64
#: Half the core, px: the lit extent times one and a bit, more where the light falls off slowly.
_WIDER, _SOFTER, _MARGIN = 1.1, 1.5, 3.0
#: The ring about the core that tells the background's slope, over the core.
_RING_SHARE = 0.25
#: As much as this, over the peak, a pixel counts at most.
_MOST = np.float32(4.0)
#: In the ring, a pair that differs by this share of the peak and so many deviations is cleaned.
_RING_BAD, _BAD = 0.1, 5.0
_ZERO, _HALF, _ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)


@compiled
def _window(light: Floats, middle: NDArray[np.int64], height: int, width: int, box: Any) -> bool:
    """Write where the window and its core lie to `box`; False where the edge cuts the core."""
    wide, high, fill = light[2], light[3], light[7]
    m_x, m_y = middle
    wider = _WIDER + _SOFTER * (1.0 - min(max(fill, 0.5), 1.0))
    half_x, half_y = wider * wide + _MARGIN, wider * high + _MARGIN
    ring_x, ring_y = max(REACH, _RING_SHARE * half_x), max(REACH, _RING_SHARE * half_y)
    left = max(math.ceil(0.5 * m_x - half_x - ring_x), 0, m_x - (width - 1))
    top = max(math.ceil(0.5 * m_y - half_y - ring_y), 0, m_y - (height - 1))
    columns, last = m_x - 2 * left + 1, m_y - top
    if columns < 2.0 * wide + 2.0 or last - top < 2.0 * high + 1.0:
        return False
    first = max(math.ceil(0.5 * m_x - half_x) - left, 0)
    above = max(math.ceil(0.5 * m_y - half_y) - top, 0)
    # Rows share the columns between them, so that those of the core reach no other one's.
    stride = columns + max(REACH - first, 0)
    box[0], box[1], box[2], box[3] = left, top, last, columns
    box[4], box[5], box[6] = (stride + 7) // 8 * 8, first, above
    box[7] = (last - top + 2) // 2 - above
    return True


@compiled
def _pairs(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any], box: Any, base: float, scale: float, line: Line, s: Line, d: Line
) -> None:
    """Write means of pairs to `s`, its row 0 after `REACH` others and 8, and differences to `d`."""
    left, top, last, columns, stride = box[0], box[1], box[2], box[3], box[4]
    end = np.uint64(columns - 1)  # an index that may be negative would not be vectorised
    for i in range((last - top + 2) // 2):
        upper = frame[top + i, left : left + columns]
        lower = frame[last - i, left : left + columns]
        first = 8 + (i + REACH) * stride
        means, differences = s[first : first + columns], d[i * stride : i * stride + columns]
        for j in range(columns):
            b = np.float32((lower[j] - base) * scale)
            line[j] = min(_MOST, b)
        for j in range(columns):
            differences[j] = line[end - np.uint64(j)]
        for j in range(columns):
            a = np.float32((upper[j] - base) * scale)
            a = a if a < _MOST else _MOST  # noqa: FURB136 - `min` minds NaN, which costs
            b = differences[j]
            means[j] = _HALF * (a + b)
            differences[j] = a - b


@compiled
def _complete(s: Line, rows: int, columns: int, height: int, stride: int) -> None:
    """Fill the rows below the middle by symmetry, the columns and rows around with neighbours."""
    for i in range(REACH):
        mirrored = max(height - 1 - (rows + i), 0)
        here, there = 8 + (REACH + rows + i) * stride, 8 + (REACH + mirrored) * stride
        for j in range(columns):
            s[here + j] = s[there + columns - 1 - j]
    for i in range(REACH if stride > columns else rows + 2 * REACH, rows + 2 * REACH):
        end = 8 + i * stride + columns
        following = 8 + (min(i, rows + 2 * REACH - 2) + 1) * stride
        between = _HALF * (s[end - 1] + s[following])
        s[end : 8 + (i + 1) * stride] = between
    first = s[8 + REACH * stride : 8 + (REACH + 1) * stride]
    for i in range(REACH):
        s[8 + i * stride : 8 + (i + 1) * stride] = first
    s[:8] = s[8]
    end = 8 + (rows + 2 * REACH) * stride
    s[end : end + LANES + 8] = s[end - 1]


@compiled
def _clean_ring(s: Line, d: Line, box: Any, far: float) -> None:
    """Where a pair around the core differs by more than `far`, take the darker pixel for both."""
    columns, stride, first, above = box[3], box[4], box[5], box[6]
    for i in range(above + box[7]):
        row, means = d[i * stride : i * stride + columns], s[8 + (i + REACH) * stride :]
        beyond = 0
        for j in range(columns):
            beyond += abs(row[j]) > far
        if beyond == 0:
            continue
        for j in range(columns):
            if abs(row[j]) > far and (i < above or j < first or j >= columns - first):
                means[j] -= _HALF * abs(row[j])
                row[j] = _ZERO


@compiled
def _keep(bad: NDArray[np.bool_], box: Any, keep: Line) -> None:
    """One for the core's pairs, half for those of a middle row, which appear twice; else zero.

    Minus one where `bad` (H, W; empty for none) marks either pixel.
    """
    left, top, last, columns, stride = box[0], box[1], box[2], box[3], box[4]
    first, above, rows = box[5], box[6], box[7]
    keep[:] = _ZERO
    for i in range(rows):
        keep[i * stride + first : i * stride + columns - first] = _ONE
    if (last - top) % 2 == 0:
        keep[(rows - 1) * stride + first : (rows - 1) * stride + columns - first] = _HALF
    if bad.size > 0:
        for i in range(rows):
            upper, lower = bad[top + above + i], bad[last - above - i]
            for j in range(first, columns - first):
                if upper[left + j] or lower[left + columns - 1 - j]:
                    keep[i * stride + j] = -_ONE


@compiled
def pair_up(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    which: NDArray[np.int64],
    todo: NDArray[np.int64],
    lights: Floats,
    middles: NDArray[np.int64],
    bad: NDArray[np.bool_],
    boxes: NDArray[np.int64],
    s: Line,
    d: Line,
    keep: Line,
    states: Floats,
) -> None:
    """Pair up the windows `todo` of the frames `which`; 0 columns where the edge cuts the spot."""
    _, height, width = frames.shape
    line = np.empty(width + 8, dtype=np.float32)
    for k in todo:
        box = boxes[k]
        box[:] = 0
        if not _window(lights[k], middles[k], height, width, box):
            states[k, 4] = np.inf
            continue
        base, noise, peak = lights[k, 4], lights[k, 5], lights[k, 6]
        rows = box[6] + box[7]
        stride, tall = box[4], box[2] - box[1] + 1
        d[k, : rows * stride + LANES] = _ZERO
        _pairs(frames[which[k]], box, base, 1.0 / peak, line, s[k], d[k])
        _clean_ring(s[k], d[k], box, _RING_BAD + _BAD * math.sqrt(2.0 * noise) / peak)
        _complete(s[k], rows, box[3], tall, stride)
        length = (box[7] * stride + LANES - 1) // LANES * LANES
        _keep(bad, box, keep[k, :length])
