"""Compiled products of changes over the noise's covariance (loaded on first use: Numba)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.copies import copy_matrix, copy_row

#: Elements at a time: what is summed of them stays in the processor's nearest memory.
_WIDTH = 128


@compiled
def _add_products(parts: Floats, change: Floats, weighted: Floats) -> None:
    """Add products of the changes (K, W), element by element, to those of all pairs (P, W)."""
    for i in range(change.shape[0]):
        one = weighted[i]
        for j in range(i + 1):
            part, other = parts[i * (i + 1) // 2 + j], change[j]
            for m in range(part.shape[0]):
                part[m] += one[m] * other[m]


@compiled
def _add_to_groups(
    sums: Floats, groups: NDArray[np.int64], weighted: Floats, weight: Floats
) -> None:
    """Add changes (K, W) and weights (W,) of elements to those of their groups, (G, K + 1)."""
    kinds = weighted.shape[0]
    for m in range(groups.shape[0]):
        group = sums[groups[m]]
        for i in range(kinds):
            group[i] += weighted[i, m]
        group[kinds] += weight[m]


@compiled
def _add_to_columns(sums: Floats, weighted: Floats, weight: Floats) -> None:
    """Add those of a row to the sums of the columns, (K + 1, W)."""
    for i in range(weighted.shape[0]):
        column, one = sums[i], weighted[i]
        for m in range(column.shape[0]):
            column[m] += one[m]
    last = sums[weighted.shape[0]]
    for m in range(last.shape[0]):
        last[m] += weight[m]


@compiled
def _weigh(weight: Floats, change: Floats, out: Floats) -> None:
    for m in range(out.shape[0]):
        out[m] = weight[m] * change[m]


@compiled
def _share(sums: Floats, i: int, j: int, deviation: float) -> float:
    """Return what common noise takes from a product, of sums (G, K + 1)."""
    square, total, last = deviation * deviation, 0.0, sums.shape[1] - 1
    for group in range(sums.shape[0]):
        share = square / (1.0 + square * sums[group, last])
        total += share * sums[group, i] * sums[group, j]
    return total


@compiled
def products(
    out: Floats,
    mean: Floats,
    signals: Floats,
    weights: Floats,
    shared: tuple[NDArray[np.int64], int, float],
) -> None:
    """Write products (N, K, K), as of `benchmark.metrics.noise_products.noise_products`.

    Parameters
    ----------
    out
        Overwritten.
    mean, signals, weights
        (N, M), (K, N, M) and (N, M): inverse variances.
    shared
        (N or 1, M) in which group each element is, or (0, 0) where elements are rows of so many
        columns, one after another; the number of groups, or of columns, 0 for no common noise; and
        its deviation.
    """
    groups, count, deviation = shared
    kinds, size, listed = signals.shape[0], mean.shape[1], groups.shape[0] > 0
    # so many elements at a time; where they are rows of columns, a row
    width = count if count > 0 and not listed else _WIDTH
    weight, change, weighted = np.zeros(width), np.zeros((kinds, width)), np.zeros((kinds, width))
    # element by element, added up at the end: the compiler keeps the order of a sum, which it can
    # add to one by one only
    parts = np.empty((kinds * (kinds + 1) // 2, width))
    # of each group: sums of the weighted changes, and last of the weights
    sums, by_column = np.empty((count, kinds + 1)), np.empty((kinds + 1, count))
    for n in range(mean.shape[0]):
        parts[:] = 0.0
        sums[:] = 0.0
        by_column[:] = 0.0
        for start in range(0, size, width):
            stop = min(start + width, size)
            # nothing beyond the last element
            weight[stop - start :] = 0.0
            copy_row(weights[n, start:stop], weight[: stop - start])
            for i in range(kinds):
                signal, around, one = signals[i, n, start:stop], mean[n, start:stop], change[i]
                for m in range(stop - start):
                    one[m] = signal[m] - around[m]
                _weigh(weight, one, weighted[i])
            _add_products(parts, change, weighted)
            if listed:
                mine = groups[min(n, groups.shape[0] - 1), start:stop]
                _add_to_groups(sums, mine, weighted, weight)
            elif count > 0:
                _add_to_columns(by_column, weighted, weight)
        if not listed:
            copy_matrix(by_column.T, sums)
        for i in range(kinds):
            for j in range(i + 1):
                total = parts[i * (i + 1) // 2 + j].sum() - _share(sums, i, j, deviation)
                out[n, i, j] = out[n, j, i] = total
