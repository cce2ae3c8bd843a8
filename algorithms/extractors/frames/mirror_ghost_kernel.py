"""Odd light that a spot's own slopes do not explain: another light upon it.

The last stage of `algorithms.extractors.frames.registration`, which says what the arrays hold. A
weaker light a little beside a spot makes it skew. Of all odd shapes, the cubic ones times the
spot's light are what is left of that in lowest order once the slopes are fitted.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Line = NDArray[np.float32]

_REACH = 7
#: What the slopes miss, over the peak, as the fit has it.
_FLOOR = 0.0005
#: A pixel counts as lit above this fraction of the peak.
_CUT = np.float32(0.1)
#: Slopes along both axes, and the four cubic shapes.
_SLOPES, _TERMS = 2, 6
#: Pairs of pixels, lit or not, up to which spots are looked at: larger ones show a second light's
#: outline.
_MOST = 4000


@compiled
def _sums(  # noqa: PLR0917 - Numba takes no keyword-only ones
    box: Any, s: Line, keep: Line, e: Line, state: Floats, matrix: Floats, right: Floats
) -> float:
    """Write weighted products of slopes, cubic shapes and departures; return those of the light."""
    stride, above, columns, height = box[4], box[6], box[3], box[2] - box[1]
    noise, gain = state[0] + _FLOOR * _FLOOR, state[1]
    matrix[:], right[:] = 0.0, 0.0
    light = 0.0
    terms = np.empty(_TERMS)
    length = 0.25 * math.sqrt(float(columns * columns + height * height))
    for i in range(box[7]):
        y = (above + i - 0.5 * height) / length
        at = 8 + (_REACH + above + i) * stride
        for j in range(columns):
            lit, kept = s[at + j], keep[i * stride + j]
            if not (lit > _CUT and kept > 0.0):
                continue
            x = (j - 0.5 * (columns - 1)) / length
            w = kept / (2.0 * (noise + gain * lit))
            terms[0] = s[at + j + 1] - s[at + j - 1]
            terms[1] = s[at + j + stride] - s[at + j - stride]
            xx, yy = x * x * lit, y * y * lit
            terms[2], terms[3], terms[4], terms[5] = x * xx, y * xx, x * yy, y * yy
            light += w * lit * lit
            for a in range(_TERMS):
                weighted = w * terms[a]
                right[a] += weighted * e[i * stride + j]
                for b in range(a + 1):
                    matrix[a, b] += weighted * terms[b]
    return light


@compiled
def _explained(matrix: Floats, right: Floats) -> float:
    """Chi squared that the cubic shapes explain beyond the slopes: by Cholesky, slopes first."""
    size = len(right)
    total = 0.0
    for a in range(size):
        own = matrix[a, a]
        for b in range(a):
            for c in range(b):
                matrix[a, b] -= matrix[a, c] * matrix[b, c]
            matrix[a, b] /= matrix[b, b]
            matrix[a, a] -= matrix[a, b] * matrix[a, b]
            right[a] -= matrix[a, b] * right[b]
        if not matrix[a, a] > 1e-6 * own:
            return 0.0  # too few pixels to tell shapes apart
        matrix[a, a] = math.sqrt(matrix[a, a])
        right[a] /= matrix[a, a]
        if a >= _SLOPES:
            total += right[a] * right[a]
    return total


@compiled
def skewness(  # noqa: PLR0917 - Numba takes no keyword-only ones
    boxes: NDArray[np.int64], s: Line, keep: Line, e: Line, states: Floats, out: Floats
) -> None:
    """Write how skew the spots are to `out` (N, 2).

    Columns: chi squared of four degrees of freedom, and the share of the light that is skew,
    squared. Zero where too few or too many pixels are lit.
    """
    matrix, right = np.empty((_TERMS, _TERMS)), np.empty(_TERMS)
    for k in range(len(out)):
        out[k] = 0.0
        box = boxes[k]
        if not np.isfinite(states[k, 4]) or box[3] * box[7] > _MOST:
            continue
        light = _sums(box, s[k], keep[k], e[k], states[k], matrix, right)
        if light > 0.0:
            out[k, 0] = _explained(matrix, right)
            out[k, 1] = out[k, 0] / light
