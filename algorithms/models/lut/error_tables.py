"""What look-up tables of calibration errors share: their grid, their hull and their solution.

A table holds the error (true minus nominal angle) on a regular grid of nominal angles. Its nodes
are those whose interpolation fits the calibration samples best; where samples leave a node open,
the smoothest continuation fills it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats, UnusableDataError
from algorithms.models.conditioning import WORST_CONDITION

Solver = Callable[[Floats], Floats]

MAX_NODES = 250_000
"""Largest table solved for: half a thousand nodes an axis."""

MAX_BAND = 16_000_000
"""Most numbers (128 MB) of a system solved as a band, up to here the faster way; LAPACK's, not
SuperLU's."""

_INVERSE_ITERATIONS = 8

_SAFE_PIVOT = 1e-3
"""Smallest pivot of such equations from which on their condition is below the worst by far."""


@dataclass(frozen=True)
class GridAxis:
    """Evenly spaced nodes along one axis: ``start + k interval``, k = 0..nodes - 1."""

    start: float
    interval: float
    nodes: int

    @classmethod
    def covering(cls, values: Floats, interval: float) -> GridAxis:
        """Return the axis with nodes at multiples of `interval` that encloses all values."""
        first = int(np.floor(values.min() / interval))
        last = max(int(np.ceil(values.max() / interval)), first + 1)
        return cls(first * interval, interval, last - first + 1)

    def cells(self, values: Floats) -> tuple[NDArray[np.int64], Floats]:
        """Lower node of each value's cell and the fraction past it; end cells go on outside."""
        place = (values - self.start) / self.interval
        known = np.where(np.isnan(place), 0.0, place)
        lower = np.clip(np.floor(known), 0, self.nodes - 2).astype(np.int64)
        return lower, place - lower


def convex_hull(points: Floats, by: str) -> Floats:
    """Facets (m, 3) of the convex hull of points (n, 2): outward unit normal and offset.

    Raises
    ------
    UnusableDataError
        If the points lie on one line.
    """
    from scipy.spatial import ConvexHull, QhullError  # noqa: PLC0415 - SciPy, at the first fit

    try:
        hull = ConvexHull(points)
    except QhullError as error:
        raise UnusableDataError(
            f"{by} needs calibration samples that spread over both angles; they lie on one line"
        ) from error
    return np.asarray(hull.equations, dtype=np.float64)


def distance_outside(points: Floats, hull: Floats) -> Floats:
    """Distance (N,) of points (N, 2) past the hull's nearest facet line; negative inside."""
    past = points[:, :1] * hull[:, 0] + points[:, 1:] * hull[:, 1] + hull[:, 2]
    return np.asarray(past.max(axis=1), dtype=np.float64)


def interpolation_matrix(axis: GridAxis, values: Floats) -> Any:
    """Sparse (n, nodes): the weights of the two nodes around each value."""
    from scipy.sparse import csr_array  # noqa: PLC0415 - SciPy, at the first fit only

    lower, fraction = axis.cells(values)
    rows = np.arange(len(values))
    return csr_array(
        (
            np.concatenate([1.0 - fraction, fraction]),
            (np.concatenate([rows, rows]), np.concatenate([lower, lower + 1])),
        ),
        shape=(len(values), axis.nodes),
    )


@lru_cache(maxsize=16)
def surface_roughness(rows: int, columns: int) -> Any:
    """Sparse (nodes, nodes): the squared second differences of a table of rows x columns nodes.

    Along either axis, and of both together.
    """
    from scipy.sparse import kron  # noqa: PLC0415 - SciPy, at the first fit only

    parts = (
        kron(_differences(rows, 1), _differences(columns, 1)),
        kron(_differences(rows, 2), np.eye(columns)),
        kron(np.eye(rows), _differences(columns, 2)),
    )
    return sum(part.T @ part for part in parts)


@lru_cache(maxsize=16)
def row_roughness(rows: int, terms: int) -> Any:
    """Sparse (rows terms, rows terms): squared second differences of terms from row to row."""
    from scipy.sparse import kron  # noqa: PLC0415 - SciPy, at the first fit only

    part = kron(_differences(rows, 2), np.eye(terms))
    return part.T @ part


def _differences(nodes: int, order: int) -> Any:
    """Sparse (nodes - order, nodes): differences of the given order between neighbours."""
    from scipy.sparse import csr_array  # noqa: PLC0415 - SciPy, at the first fit only

    return csr_array(np.diff(np.eye(nodes), n=order, axis=0))


def solve_table(design: Any, roughness: Any, weight: float, errors: Floats, by: str) -> Floats:
    """Nodes (nodes, 2) that fit errors (n, 2) best, with `weight` times their squared roughness.

    Raises
    ------
    UnusableDataError
        If the samples settle the nodes so badly that rounding would show in them.
    """
    normal = (design.T @ design + weight * roughness).tocoo()
    row, column = normal.coords
    width = int((row - column).max())
    if normal.shape[0] * (width + 1) > MAX_BAND:
        solve, pivots = _factored_sparse(normal)
    else:
        solve, pivots = _factored_band(normal, width)
    scale = np.sqrt(normal.diagonal())
    # what the factor would be, were the diagonal brought to ones
    pivot = float(np.min(pivots / scale**2))
    if not (pivot > _SAFE_PIVOT or _condition(solve, scale) <= WORST_CONDITION):
        raise UnusableDataError(
            f"{by}: the samples settle the table too badly: its equations' condition is above "
            f"{WORST_CONDITION:g}, so that rounding would show in its numbers"
        )
    return np.asarray(solve(design.T @ errors), dtype=np.float64)


def _factored_band(normal: Any, width: int) -> tuple[Solver, Floats]:
    """Solver of equations by a banded Cholesky factor, and the factor's squared pivots."""
    from scipy.linalg import cho_solve_banded, cholesky_banded  # noqa: PLC0415 - at the first fit

    row, column = normal.coords
    below = row - column
    lower = below >= 0
    band = np.zeros((width + 1, normal.shape[0]))
    band[below[lower], column[lower]] = normal.data[lower]
    try:
        factor = cholesky_banded(band, overwrite_ab=True, lower=True, check_finite=False)
    except np.linalg.LinAlgError:  # singular but for rounding
        return np.zeros_like, np.zeros(normal.shape[0])
    return partial(cho_solve_banded, (factor, True), check_finite=False), factor[0] ** 2


def _factored_sparse(normal: Any) -> tuple[Solver, Floats]:
    """`_factored_band` for equations whose band would be too wide."""
    from scipy.sparse import csc_array  # noqa: PLC0415 - SciPy, at the first fit only
    from scipy.sparse.linalg import splu  # noqa: PLC0415

    # symmetric and positive definite: pivots stay on the diagonal, ordering keeps the symmetry
    factors = splu(
        csc_array(normal),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return factors.solve, np.abs(factors.U.diagonal())[factors.perm_c]


def _condition(solve: Solver, scale: Floats) -> float:
    """Estimate the condition of equations brought to a diagonal of ones, by inverse iteration.

    Infinite without a factor. `scale` are the roots of the diagonal. The largest eigenvalue is
    between 1 and the number of terms a row; what decides is the smallest.
    """
    # a start with a share in every eigenvector, the same everywhere
    vector = np.cos(np.arange(len(scale)) * 2.399963229728653)
    growth = 0.0
    for _ in range(_INVERSE_ITERATIONS):
        vector /= np.sqrt(vector @ vector)
        vector = scale * np.asarray(solve(scale * vector), dtype=np.float64)
        growth = float(np.sqrt(vector @ vector))
        if not (0.0 < growth < np.inf):
            return np.inf
    return growth


def row_products(left: Any, right: Any) -> Any:
    """Sparse (n, a b): each row the Kronecker product of a row of (n, a) and one of (n, b)."""
    from scipy.sparse import csr_array  # noqa: PLC0415 - SciPy, at the first fit only

    left, right = left.tocoo(), right.tocsr()
    columns = right.shape[1]
    width = np.diff(right.indptr)
    # Each stored left entry meets every stored right entry of its row.
    row, left_column = left.coords
    repeats = width[row]
    starts = np.repeat(right.indptr[row], repeats)
    within = np.arange(repeats.sum()) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    entry = starts + within
    return csr_array(
        (
            np.repeat(left.data, repeats) * right.data[entry],
            (
                np.repeat(row, repeats),
                np.repeat(left_column, repeats).astype(np.int64) * columns + right.indices[entry],
            ),
        ),
        shape=(left.shape[0], left.shape[1] * columns),
    )


def require_size(unknowns: int, by: str, interval_deg: float) -> None:
    """Raise UnusableDataError when a table would have more than `MAX_NODES` unknowns."""
    if unknowns > MAX_NODES:
        raise UnusableDataError(
            f"{by}: interval_deg={interval_deg!r} makes a table of {unknowns} unknowns over the "
            f"calibrated field; at most {MAX_NODES} are solved for"
        )
