"""What look-up tables of calibration errors share: their grid, their hull and their solution.

A table holds the error (true minus nominal angle) on a regular grid of nominal angles. Its nodes
are those whose interpolation fits the calibration samples best; where samples leave a node open,
the smoothest continuation fills it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.conditioning import WORST_CONDITION
from algorithms.contract import Floats, UnusableDataError

Solver = Callable[[Floats], Floats]

MAX_NODES = 250_000
"""Largest table solved for: half a thousand nodes an axis."""

SMOOTHINGS = (1e-3, 1e-1, 1e1, 1e3, 1e5)
"""Weights tried where none is given; the first only fills what no sample settles."""

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
    def over(cls, values: Floats, interval: float) -> GridAxis:
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
    stiff = _lower_entries(roughness)
    width = max(_width_of_rows(design), stiff.width)
    if design.shape[1] * (width + 1) > MAX_BAND:
        normal, right = design.T @ design + weight * roughness, design.T @ errors
        diagonal = normal.diagonal()
        solve, pivots = _factored_sparse(normal)
    else:
        every = np.ones(len(errors), dtype=np.bool_)
        equations, right = _sums(design, every, errors, width)
        equations[stiff.below, stiff.column] += weight * stiff.entries
        diagonal = equations[0].copy()
        solve, pivots = _factored_band(equations)
    if not _settled(solve, pivots, diagonal):
        raise UnusableDataError(
            f"{by}: the samples settle the table too badly: its equations' condition is above "
            f"{WORST_CONDITION:g}, so that rounding would show in its numbers"
        )
    return np.asarray(solve(right), dtype=np.float64)


def errors_left_out(
    design: Any,
    roughness: Any,
    weights: Sequence[float],
    errors: Floats,
    parts: Sequence[tuple[NDArray[np.bool_], NDArray[np.bool_]]],
) -> Floats:
    """Root mean squared error on samples left out, of each weight; infinite where not settled.

    What `solve_table` would give of each part and weight, with the equations of a part assembled
    once for all weights.

    Parameters
    ----------
    design : sparse, shape (n, nodes)
        Of all samples.
    roughness : sparse, shape (nodes, nodes)
        As `solve_table` takes it.
    weights : sequence of float
        Of the roughness.
    errors : ndarray, shape (n, 2)
        To fit.
    parts : sequence of (ndarray, ndarray)
        Which samples are fitted and which left out, as masks (n,).
    """
    from algorithms.models.lut.table_kernel import interpolate  # noqa: PLC0415 - Numba

    total, count = np.zeros(len(weights)), 0
    stiff = _lower_entries(roughness)
    width = max(_width_of_rows(design), stiff.width)
    bends = np.zeros((width + 1, design.shape[1]), order="F")
    bends[stiff.below, stiff.column] = stiff.entries
    for fitted, left_out in parts:
        sums, right = _sums(design, fitted, errors, width)
        missed = errors[left_out]
        asked = np.empty(missed.shape)
        count += len(missed)
        for number, weight in enumerate(weights):
            equations = sums + weight * bends
            diagonal = equations[0].copy()
            solve, pivots = _factored_band(equations)
            if _settled(solve, pivots, diagonal):
                interpolate(
                    design.indptr, design.indices, design.data, left_out, solve(right), asked
                )
                total[number] += float(((asked - missed) ** 2).sum())
            else:
                total[number] = np.inf
    return np.sqrt(total / count) if count else np.full(len(weights), np.inf)


def _settled(solve: Solver, pivots: Floats, diagonal: Floats) -> bool:
    """Whether factored equations are far enough from singular for rounding not to show."""
    # what the factor would be, were the diagonal brought to ones
    if float(np.min(pivots / diagonal)) > _SAFE_PIVOT:
        return True
    return _condition(solve, np.sqrt(diagonal)) <= WORST_CONDITION


@dataclass(frozen=True)
class _LowerEntries:
    """Numbers of a sparse symmetric matrix, on and below its diagonal: how far below, and where."""

    below: NDArray[np.int64]
    column: NDArray[np.int64]
    entries: Floats

    @property
    def width(self) -> int:
        """How far from the diagonal there are numbers."""
        return int(self.below.max(initial=0))


def _lower_entries(matrix: Any) -> _LowerEntries:
    found = matrix.tocoo()
    row, column = found.coords
    lower = row >= column
    return _LowerEntries((row - column)[lower], column[lower], found.data[lower])


def _width_of_rows(design: Any) -> int:
    """How far apart the nodes around one sample are numbered."""
    last = design.indices[design.indptr[1:] - 1]
    return int((last - design.indices[design.indptr[:-1]]).max(initial=0))


def _sums(
    design: Any, fitted: NDArray[np.bool_], errors: Floats, width: int
) -> tuple[Floats, Floats]:
    """Lower band (width + 1, nodes) of the normal equations of some samples, and their right."""
    from algorithms.models.lut.table_kernel import add_samples  # noqa: PLC0415 - Numba

    band = np.zeros((width + 1, design.shape[1]), order="F")  # as LAPACK has it
    right = np.zeros((design.shape[1], errors.shape[1]))
    add_samples(design.indptr, design.indices, design.data, fitted, errors, band, right)
    return band, right


def _factored_band(band: Floats) -> tuple[Solver, Floats]:
    """Solver of equations by a banded Cholesky factor, and the factor's squared pivots.

    The band is overwritten.
    """
    # not by SciPy's functions around them, whose checks take longer than small equations
    from scipy.linalg.lapack import dpbtrf, dpbtrs  # noqa: PLC0415 - SciPy, at the first fit only

    factor, failed = dpbtrf(band, lower=True, overwrite_ab=True)
    if failed:  # singular but for rounding
        return np.zeros_like, np.zeros(band.shape[1])
    return lambda right: np.asarray(dpbtrs(factor, right, lower=True)[0]), factor[0] ** 2


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
