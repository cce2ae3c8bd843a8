"""Lines of pairs, as all stages of `mirror.registration` read them: places, sums, symmetry, noise.

A window's pairs stand row after row, a stride apart. Sums are taken in lanes side by side, so that
they are vectorised without being reordered.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.mirror import taps
from algorithms.extractors.frames.mirror.records import Box, State

Line = NDArray[np.float32]

#: Rows and columns around the core that its slopes reach; lanes of most sums; lines end at
#: multiples of the last.
REACH, LANES, WHOLE = 7, 16, 64
#: What the slopes miss, over the peak: pixels are not trusted to better than that.
FLOOR = 0.0005
ZERO, HALF, ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
#: What the slopes' own noise adds to departures.
_OWN, _COMMON = taps.noise_of_slopes()


@compiled
def padded_length(box: Box) -> int:
    """Numbers in a line of the core, up to a multiple of `WHOLE`."""
    return (box.rows * box.stride + WHOLE - 1) // WHOLE * WHOLE


@compiled
def core_start(box: Box) -> int:
    """Index of the core's first pair in a line of means, which has a margin around it."""
    return 8 + (REACH + box.above) * box.stride


@compiled
def fold(lanes: Line, which: int, width: int) -> float:
    """Sum of the `width` lanes of one of several sums, halves added to halves; they are used up."""
    p = which * width
    half = width // 2
    while half >= 8:
        for j in range(half):
            lanes[p + j] += lanes[p + j + half]
        half //= 2
    a, b = float(lanes[p]) + lanes[p + 1], float(lanes[p + 2]) + lanes[p + 3]
    c, e = float(lanes[p + 4]) + lanes[p + 5], float(lanes[p + 6]) + lanes[p + 7]
    total: float = (a + b) + (c + e)
    return total


@compiled
def places(box: Box, scale: float, x: Line, y: Line) -> None:
    """Write x and y of the core's pairs, from the middle, times a scale."""
    stride, factor = box.stride, np.float32(scale)
    for j in range(stride):
        x[j] = factor * np.float32(j - 0.5 * (box.columns - 1))
    for i in range(box.rows):
        first = np.uint64(i * stride)
        along = factor * np.float32(box.above + i - 0.5 * (box.last - box.top))
        for j in range(stride):
            q = first + np.uint64(j)  # what is never negative is vectorised
            x[q] = x[j]
            y[q] = along
    for j in range(box.rows * stride, x.size):
        x[j], y[j] = ZERO, ZERO


@compiled
def mirror_below(s: Line, box: Box) -> None:
    """Fill the rows below the middle by symmetry."""
    columns, stride, rows = box.columns, box.stride, box.above + box.rows
    height = box.last - box.top + 1
    for i in range(REACH):
        mirrored = max(height - 1 - (rows + i), 0)
        here, there = 8 + (REACH + rows + i) * stride, 8 + (REACH + mirrored) * stride
        out, far = s[here : here + columns], np.uint64(there + columns - 1)
        for j in range(columns):
            out[j] = s[far - np.uint64(j)]


@compiled
def _polynomial(coefficients: Floats, d2: float) -> float:
    total = 0.0
    for k in range(coefficients.size):
        total = total * d2 + coefficients[coefficients.size - 1 - k]
    return total


@compiled
def departure_noise(state: State) -> tuple[float, float]:
    """Variance of a pair's departure, and of neighbours', over that of the noise of their pixels.

    What predicts the departure has noise of the same pixels' means, half of it in each axis.
    """
    a, b = state.slopes_d[0] * state.slopes_d[0], state.slopes_d[1] * state.slopes_d[1]
    own = 1.0 + 0.5 * (a * _polynomial(_OWN, a) + b * _polynomial(_OWN, b))
    return own, own - 0.5 * a * _polynomial(_COMMON, a)
