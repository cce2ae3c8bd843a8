"""Balance of five areas around a spot, on both axes at once, moved until the spot is centred."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

_HALF = 10  # of the window's 21 columns: 1 | 9 | 1 | 9 | 1


@compiled
def _window_sums(
    frame: NDArray[Any], x: int, y: int, columns: Floats, rows: Floats
) -> tuple[int, int, int, int]:
    """Sum the columns and rows (21,) of the window centred on a pixel.

    Pixels outside the frame count as the mean of the window's rim inside it. Returns the first
    and last column and row of the window that are inside.
    """
    height, width = frame.shape
    left, right = max(_HALF - x, 0), min(width - 1 - x + _HALF, 2 * _HALF)
    top, bottom = max(_HALF - y, 0), min(height - 1 - y + _HALF, 2 * _HALF)
    columns[:] = 0.0
    rim = 0.0
    rim_pixels = 0
    for i in range(2 * _HALF + 1):
        rows[i] = 0.0
        if not top <= i <= bottom:
            continue
        row = frame[y - _HALF + i, x - _HALF + left : x - _HALF + right + 1]
        inside = columns[left : right + 1]
        total = 0.0
        for j in range(row.size):
            u = float(row[j])
            inside[j] += u
            total += u
        rows[i] = total
        if i in (0, 2 * _HALF):
            rim += total
            rim_pixels += row.size
        else:
            if left == 0:
                rim += row[0]
                rim_pixels += 1
            if right == 2 * _HALF:
                rim += row[row.size - 1]
                rim_pixels += 1
    dark = rim / rim_pixels if rim_pixels > 0 else 0.0
    across = 2 * _HALF + 1
    for j in range(across):
        columns[j] += dark * (across - (bottom - top + 1) if left <= j <= right else across)
        rows[j] += dark * (across - (right - left + 1) if top <= j <= bottom else across)
    return left, right, top, bottom


@compiled
def _balance(sums: Floats, first: int, last: int) -> tuple[float, bool]:
    """Offset of the light's middle from the window's, px, and whether the window holds it.

    It does not where the outermost columns inside the frame, `first` and `last`, differ by more
    than half of the centre column's light.
    """
    before = 0.0
    after = 0.0
    for j in range(1, _HALF):
        before += sums[j]
        after += sums[_HALF + j]
    centre = sums[_HALF]
    dark = 0.5 * (sums[0] + sums[2 * _HALF])
    rise = centre - dark
    # No further than half of the window's half: beyond, its outer columns may be the lit ones.
    furthest = 0.5 * _HALF
    offset = furthest if after > before else -furthest
    if 2 * rise * furthest > abs(after - before):
        offset = 0.5 * (after - before) / rise
    apart = abs(sums[first] - sums[last])
    return offset, apart < 0.5 * (centre - min(sums[first], sums[last]))


@compiled
def _single(sums: Floats) -> float:
    """Offset that a window's sums tell, px, as printed; NaN where the centre is no brighter."""
    rise = sums[_HALF] - 0.5 * (sums[0] + sums[2 * _HALF])
    turned = sums[_HALF + 1 : 2 * _HALF].sum() - sums[1:_HALF].sum()
    return float(0.5 * turned / rise) if rise > 0.0 else np.nan


@compiled
def five_areas(frames: NDArray[Any], start: Floats, moves: int, out: Floats) -> None:
    """Write the balanced position (x, y) of each frame's spot to `out` (N, 2).

    `start` (N, 2) are the pixels of the first windows. A NaN row where the window does not
    converge within `moves`, or does not hold the whole spot. Without moves the balance in the
    first window stands, where its centre is brighter than its ends on both axes.
    """
    count, height, width = frames.shape
    columns = np.empty(2 * _HALF + 1)
    rows = np.empty(2 * _HALF + 1)
    for k in range(count):
        out[k, 0] = np.nan
        out[k, 1] = np.nan
        x, y = int(start[k, 0]), int(start[k, 1])
        if moves == 0:
            _window_sums(frames[k], x, y, columns, rows)
            out[k, 0] = x + _single(columns)
            out[k, 1] = y + _single(rows)
        for _ in range(moves):
            left, right, top, bottom = _window_sums(frames[k], x, y, columns, rows)
            off_x, whole_x = _balance(columns, left, right)
            off_y, whole_y = _balance(rows, top, bottom)
            if abs(off_x) <= 0.5 and abs(off_y) <= 0.5:
                if whole_x and whole_y:
                    out[k, 0] = x + off_x
                    out[k, 1] = y + off_y
                break
            # A light between two pixels is settled where either is its middle.
            moved_x = min(max(x + round(off_x), 0), width - 1)
            moved_y = min(max(y + round(off_y), 0), height - 1)
            if moved_x == x and moved_y == y:
                break
            if abs(off_x) < 1 and abs(off_y) < 1 and whole_x and whole_y:
                out[k, 0] = x + off_x
                out[k, 1] = y + off_y
            x, y = moved_x, moved_y
