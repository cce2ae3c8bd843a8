"""What models of detectors facing different ways share: their normals and sums over them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from algorithms.contract import Floats, UnsuitableDesignError

Normals = tuple[tuple[float, float, float], ...]

UNIT_TOLERANCE = 1e-6
"""Largest departure of a normal's length from one, and of two normals' cosine from a design's."""


def require_normals(face_normals: Normals, by: str) -> Floats:
    """Return the normals (K, 3), K at least three, unit vectors that do not lie in one plane.

    Raises
    ------
    UnsuitableDesignError
        Otherwise, naming `by`.
    """
    normals = np.asarray(face_normals, dtype=np.float64)
    if normals.ndim == 2 and normals.shape[0] >= 3 and normals.shape[1] == 3:
        unit = np.abs(np.linalg.norm(normals, axis=1) - 1.0) <= UNIT_TOLERANCE
        if unit.all() and np.linalg.svd(normals, compute_uv=False)[-1] > UNIT_TOLERANCE:
            return normals
    raise UnsuitableDesignError(
        f"{by} needs at least three unit face normals that span space; got {face_normals!r}"
    )


def axis_faces(face_normals: Normals, by: str) -> tuple[list[int], list[int]]:
    """Columns of the +x, +y, +z faces and of the -x, -y, -z faces of a cube, in any order.

    Raises
    ------
    UnsuitableDesignError
        If the faces are not these six, naming `by`.
    """
    normals = np.asarray(face_normals, dtype=np.float64)
    axes = np.vstack([np.eye(3), -np.eye(3)])
    if normals.shape == (6, 3):
        match = (np.abs(normals - axes[:, None]) <= UNIT_TOLERANCE).all(axis=2)
        if (match.sum(axis=0) == 1).all() and (match.sum(axis=1) == 1).all():
            columns = [int(column) for column in match.argmax(axis=1)]
            return columns[:3], columns[3:]
    raise UnsuitableDesignError(
        f"{by} needs six face normals, +-x, +-y and +-z each once; got {face_normals!r}"
    )


def require_square_pairs(face_normals: Normals, by: str) -> Floats:
    """Return the normals (6, 3): three pairs of opposite ones, the pairs square to each other.

    Raises
    ------
    UnsuitableDesignError
        Otherwise, naming `by`.
    """
    normals = np.asarray(face_normals, dtype=np.float64)
    if normals.shape == (6, 3):
        # row by row one opposite (-1), itself (1) and four at right angles (0)
        cosines = np.sort(normals @ normals.T, axis=1)
        if np.allclose(cosines, [-1.0, 0.0, 0.0, 0.0, 0.0, 1.0], rtol=0, atol=UNIT_TOLERANCE):
            return normals
    raise UnsuitableDesignError(
        f"{by} needs six panel normals, three opposite pairs square to each other; "
        f"got {face_normals!r}"
    )


def opposite_pairs(normals: Floats) -> tuple[tuple[int, int], ...]:
    """Panels of each pair of `require_square_pairs`, the earlier one first."""
    opposite = (normals @ normals.T).argmin(axis=1)
    return tuple((one, int(other)) for one, other in enumerate(opposite) if one < other)


def row_sums(columns: Floats, weights: Sequence[float] | Floats) -> Floats:
    """``sum_k weights_k columns_k`` (N,) of (N, K), added column by column.

    A matrix product adds in an order that depends on how many rows there are.
    """
    total = np.zeros(len(columns))
    for column, weight in zip(columns.T, weights, strict=True):
        total += weight * column
    return total


def directions(half_fov_deg: float | None, count: int = 4000) -> Floats:
    """Return unit vectors (N, 3) that fill the field of view around +z evenly, with its rim.

    Parameters
    ----------
    half_fov_deg : float or None
        Half the cone's angle; None for all directions.
    count : int
        Vectors inside, on a Fibonacci lattice; a tenth as many follow the rim.
    """
    lowest = -1.0 if half_fov_deg is None else float(np.cos(np.radians(half_fov_deg)))
    steps = np.arange(count)
    z = np.append(1.0 - (1.0 - lowest) * (steps + 0.5) / count, np.full(count // 10, lowest))
    turn = np.append(np.pi * (3.0 - np.sqrt(5.0)) * steps, np.linspace(0, 2 * np.pi, count // 10))
    radius = np.sqrt(np.maximum(1.0 - z**2, 0.0))
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), z])
