"""Numbers between the nodes of a table, many places at a time."""

from __future__ import annotations

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats


@compiled
def corrected(
    nominal: Floats,
    table: Floats,
    starts: tuple[float, float],
    interval: float,
    out: Floats,
) -> None:
    """Angles (N, 2) plus what a table has there, bilinear between its nodes, into `out`.

    Parameters
    ----------
    nominal : ndarray, shape (N, 2)
        Angles; a NaN row stays one.
    table : ndarray, shape (A, B, 2)
        Numbers to add; end cells go on outside.
    starts : tuple of two float
        First node of each axis.
    interval : float
        Between nodes.
    out : ndarray, shape (N, 2)
        Overwritten.
    """
    first, second = starts
    rows, columns = table.shape[0] - 2.0, table.shape[1] - 2.0
    for n in range(len(nominal)):
        across = np.divide(nominal[n, 0] - first, interval)
        along = np.divide(nominal[n, 1] - second, interval)
        if np.isnan(across) or np.isnan(along):
            out[n, 0] = out[n, 1] = np.nan
            continue
        i = int(min(max(np.floor(across), 0.0), rows))
        j = int(min(max(np.floor(along), 0.0), columns))
        u, v = across - i, along - j
        for k in range(2):
            lower = (1.0 - v) * table[i, j, k] + v * table[i, j + 1, k]
            upper = (1.0 - v) * table[i + 1, j, k] + v * table[i + 1, j + 1, k]
            out[n, k] = nominal[n, k] + ((1.0 - u) * lower + u * upper)
