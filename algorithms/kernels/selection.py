"""Medians by selection: a few passes over a row, without sorting it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Passes after which what is left is sorted: rows on which pivots are always bad are rare.
_PASSES = 50


@compiled
def _select(values: NDArray[Any], rank: int) -> None:
    """Put the value of a rank in its place, those not above it before and the others behind.

    Hoare's selection. Values are moved without asking, and counted where they are below the pivot:
    a branch that depends on noise is guessed wrong every other time.
    """
    first, last = 0, values.size - 1
    for _ in range(_PASSES):
        if first >= last:
            return
        middle, quarter = (first + last) // 2, (last - first) // 4
        at = middle
        a, b, c = values[first + quarter], values[middle], values[last - quarter]
        if (b <= a) == (a <= c):
            at = first + quarter
        elif (a <= c) == (c <= b):
            at = last - quarter
        pivot = values[at]
        values[at], values[last] = values[last], pivot
        end = first
        for i in range(first, last):
            value = values[i]
            values[i] = values[end]
            values[end] = value
            end += value < pivot
        values[last], values[end] = values[end], pivot
        if end > rank:
            last = end - 1
            continue
        stop = end + 1
        if end == first:  # none is below the pivot: those equal to it come next
            for i in range(stop, last + 1):
                value = values[i]
                values[i] = values[stop]
                values[stop] = value
                stop += value == pivot
        if rank < stop:
            return
        first = stop
    values[first : last + 1].sort()


@compiled
def row_medians(rows: NDArray[Any], out: Floats) -> None:
    """Write the medians of rows (N, M) to `out` (N,); NaN for a row that holds one."""
    count, length = rows.shape
    middle = length // 2
    values = np.empty(length, rows.dtype)
    for r in range(count):
        broken = 0
        for i in range(length):
            values[i] = rows[r, i]
            broken |= values[i] != values[i]
        if broken:
            out[r] = np.nan
            continue
        _select(values, middle)
        if length % 2:
            out[r] = values[middle]
        else:
            out[r] = 0.5 * (values[middle] + float(values[:middle].max()))
