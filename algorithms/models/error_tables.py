"""What look-up tables of calibration errors share: their grid, their hull and their solution.

A table holds the error (true minus nominal angle) on a regular grid of nominal angles. Its nodes
are those whose interpolation fits the calibration samples best; where samples leave a node open,
the smoothest continuation fills it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

MAX_NODES = 250_000

MAX_BAND = 16_000_000
"""Most numbers (128 MB) of a system solved as a band, up to here the faster way; LAPACK's, not
SuperLU's."""
"""Largest table solved for: half a thousand nodes an axis."""


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
    ValueError
        If the points lie on one line.
    """
    from scipy.spatial import ConvexHull, QhullError  # noqa: PLC0415 - SciPy, at the first fit

    try:
        hull = ConvexHull(points)
    except QhullError as error:
        raise ValueError(
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


def difference_matrix(nodes: int, order: int) -> Any:
    """Sparse (nodes - order, nodes): differences of the given order between neighbours."""
    from scipy.sparse import csr_array  # noqa: PLC0415 - SciPy, at the first fit only

    return csr_array(np.diff(np.eye(nodes), n=order, axis=0))


def solve_table(design: Any, roughness: list[Any], weight: float, errors: Floats) -> Floats:
    """Nodes (nodes, 2) that fit errors (n, 2) best, with `weight` times the squared roughness."""
    from scipy.linalg import solveh_banded  # noqa: PLC0415 - SciPy, at the first fit only

    normal = design.T @ design
    for differences in roughness:
        normal = normal + weight * (differences.T @ differences)
    normal, wanted = normal.tocoo(), np.ascontiguousarray(design.T @ errors)
    row, column = normal.coords
    below = row - column
    width = int(below.max())
    if normal.shape[0] * (width + 1) > MAX_BAND:
        return _solved_sparse(normal, wanted)
    lower = below >= 0
    band = np.zeros((width + 1, normal.shape[0]))
    band[below[lower], column[lower]] = normal.data[lower]
    solved = solveh_banded(band, wanted, overwrite_ab=True, lower=True, check_finite=False)
    return np.asarray(solved, dtype=np.float64)


def _solved_sparse(normal: Any, wanted: Floats) -> Floats:
    from scipy.sparse import csc_array  # noqa: PLC0415 - SciPy, at the first fit only
    from scipy.sparse.linalg import splu  # noqa: PLC0415

    # symmetric and positive definite: pivots stay on the diagonal, ordering keeps the symmetry
    factors = splu(
        csc_array(normal),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return np.asarray(factors.solve(wanted), dtype=np.float64)


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
    """Raise ValueError when a table would have more than `MAX_NODES` unknowns."""
    if unknowns > MAX_NODES:
        raise ValueError(
            f"{by}: interval_deg={interval_deg!r} makes a table of {unknowns} unknowns over the "
            f"calibrated field; at most {MAX_NODES} are solved for"
        )
