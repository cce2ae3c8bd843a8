"""Numbers between the nodes of a table, many places at a time, and the equations of the nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Places = NDArray[np.int32]
Chosen = NDArray[np.bool_]


@compiled
def correct(
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


@compiled
def corrected_along_rows(
    nominal: Floats,
    rows: Floats,
    first: tuple[float, float],
    scaling: tuple[float, float],
    out: Floats,
) -> None:
    """Angles (N, 2) plus polynomials of beta, blended from row to row of alpha, into `out`.

    Parameters
    ----------
    nominal : ndarray, shape (N, 2)
        Angles (alpha, beta); a NaN row stays one.
    rows : ndarray, shape (R, n + 1, 2)
        Chebyshev coefficients of each row, n at least 1; end rows go on outside.
    first : tuple of two float
        Alpha of the first row, and between rows.
    scaling : tuple of two float
        Middle and half range of beta.
    out : ndarray, shape (N, 2)
        Overwritten.
    """
    start, interval = first
    middle, half = scaling
    last, terms = rows.shape[0] - 2.0, rows.shape[1]
    for n in range(len(nominal)):
        place = np.divide(nominal[n, 0] - start, interval)
        x = np.divide(nominal[n, 1] - middle, half)
        if np.isnan(place) or np.isnan(x):
            out[n, 0] = out[n, 1] = np.nan
            continue
        i = int(min(max(np.floor(place), 0.0), last))
        w = place - i
        twice = 2.0 * x
        for k in range(2):
            low = (1.0 - w) * rows[i, terms - 2, k] + w * rows[i + 1, terms - 2, k]
            high = (1.0 - w) * rows[i, terms - 1, k] + w * rows[i + 1, terms - 1, k]
            for term in range(terms - 3, -1, -1):  # Clenshaw's recurrence
                before = low
                low = (1.0 - w) * rows[i, term, k] + w * rows[i + 1, term, k] - high
                high = before + high * twice
            out[n, k] = nominal[n, k] + (low + high * x)


@compiled
def add_samples(  # noqa: PLR0917 - Numba takes no keyword-only ones
    starts: Places,
    nodes: Places,
    shares: Floats,
    chosen: Chosen,
    errors: Floats,
    band: Floats,
    right: Floats,
) -> None:
    """Add some samples to normal equations, one after the other.

    Parameters
    ----------
    starts, nodes, shares : ndarray, shapes (n + 1,), (E,) and (E,)
        Of each sample the nodes around it, in ascending order, and their shares, as the rows of
        a sparse matrix.
    chosen : ndarray of bool, shape (n,)
        Samples to add.
    errors : ndarray, shape (n, 2)
        Wanted at each sample.
    band : ndarray, shape (W + 1, nodes)
        Products of shares, by how far they are below the diagonal; added to.
    right : ndarray, shape (nodes, 2)
        Products of shares and errors; added to.
    """
    for sample in range(len(chosen)):
        if not chosen[sample]:
            continue
        start = starts[sample]
        for entry in range(start, starts[sample + 1]):
            node, share = nodes[entry], shares[entry]
            for k in range(right.shape[1]):
                right[node, k] += share * errors[sample, k]
            for other in range(start, entry + 1):
                band[node - nodes[other], nodes[other]] += share * shares[other]


@compiled
def interpolate(  # noqa: PLR0917 - Numba takes no keyword-only ones
    starts: Places, nodes: Places, shares: Floats, chosen: Chosen, table: Floats, out: Floats
) -> None:
    """Write what nodes (nodes, 2) give at some samples, one row each, into `out` (m, 2).

    The samples as `add_samples` takes them.
    """
    row = 0
    for sample in range(len(chosen)):
        if not chosen[sample]:
            continue
        for k in range(table.shape[1]):
            value = 0.0
            for entry in range(starts[sample], starts[sample + 1]):
                value += shares[entry] * table[nodes[entry], k]
            out[row, k] = value
        row += 1
