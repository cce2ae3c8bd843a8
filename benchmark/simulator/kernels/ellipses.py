"""Compiled marks of the pixels within ellipses (loaded on first use: Numba)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats


@compiled
def mark_ellipses(
    near: NDArray[np.bool_], middles: Floats, axes: Floats, direction: Floats
) -> None:
    """Mark the pixels (rows, columns) within ellipses of one shape.

    Parameters
    ----------
    near
        Written.
    middles
        (A, 2) column and row, the first pixel's first corner at 0.
    axes, direction
        (2,) half axes, pixels, and the unit vector along the first one.
    """
    rows, columns = near.shape
    ex, ey = direction
    turn = (ex / axes[0]) ** 2 + (ey / axes[1]) ** 2
    high = math.sqrt((axes[0] * ey) ** 2 + (axes[1] * ex) ** 2)
    for x, y in middles:
        for row in range(max(math.floor(y - high), 0), min(math.ceil(y + high), rows)):
            away = row + 0.5 - y
            middle = ex * ey * away * (1.0 / axes[1] ** 2 - 1.0 / axes[0] ** 2) / turn
            rest = 1.0 - (ey * away / axes[0]) ** 2 - (ex * away / axes[1]) ** 2
            square = middle * middle + rest / turn
            if square <= 0.0:
                continue
            half = math.sqrt(square)
            first = max(math.floor(x + middle - half), 0)
            last = min(math.ceil(x + middle + half), columns)
            for column in range(first, last):
                near[row, column] = True
