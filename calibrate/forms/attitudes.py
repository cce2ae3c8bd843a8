"""Directions of the light in the sensor's frame from attitudes: quaternions and matrices."""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats

#: Departure of a quaternion's length, and of a matrix from orthonormal rows, that rounding makes.
_LENGTH, _ORTHONORMAL = 0.02, 0.02
#: Share of rows that have to be such.
_MOST = 0.95


def are_quaternions(columns: Floats) -> bool:
    """Say whether four columns (N, 4) have the length of one in most rows."""
    length = np.linalg.norm(columns, axis=1)
    return bool(np.mean(np.abs(length - 1.0) < _LENGTH) > _MOST)


def are_matrices(columns: Floats) -> bool:
    """Say whether nine columns (N, 9), row by row, are rotations in most rows."""
    return bool(_right(columns).mean() > _MOST)


def rotated(columns: Floats, light: Floats, *, scalar_first: bool, to_sensor: bool) -> Floats:
    """Return the light's direction (N, 3) in the sensor's frame.

    Parameters
    ----------
    columns : ndarray, shape (N, 4) or (N, 9)
        Quaternions, or matrices row by row.
    light : ndarray, shape (N, 3)
        Directions in the outer frame.
    scalar_first : bool
        Of quaternions.
    to_sensor : bool
        Whether ``v' = R v`` (or ``q v q*``) gives the sensor's frame; its inverse does otherwise.

    Returns
    -------
    ndarray, shape (N, 3)
        Unit vectors; NaN rows where an attitude is no rotation.
    """
    matrices = (
        columns.reshape(-1, 3, 3)
        if columns.shape[1] == 9
        else _matrices(np.roll(columns, -1, axis=1) if scalar_first else columns)
    )
    if columns.shape[1] == 9:
        matrices = np.where(_right(columns)[:, None, None], matrices, np.nan)
    turned = np.einsum("nij,nj->ni" if to_sensor else "nji,nj->ni", matrices, light)
    length = np.linalg.norm(turned, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(turned / np.where(length > 0, length, np.nan)[:, None])


def _right(columns: Floats) -> np.ndarray:
    """Return which matrices (N,) have orthonormal rows and keep hands."""
    matrices = columns.reshape(-1, 3, 3)
    off = np.einsum("nij,nkj->nik", matrices, matrices) - np.eye(3)
    with np.errstate(invalid="ignore"):
        return np.asarray((np.abs(off).max(axis=(1, 2)) < _ORTHONORMAL) & (np.linalg.det(
            np.nan_to_num(matrices)) > 0))  # fmt: skip


def _matrices(quaternions: Floats) -> Floats:
    """Rotation matrices (N, 3, 3) of quaternions (x, y, z, w); NaN where the length is not one."""
    length = np.linalg.norm(quaternions, axis=1)
    near = np.abs(length - 1.0) < 10.0 * _LENGTH
    x, y, z, w = (quaternions / np.where(near, length, np.nan)[:, None]).T
    return np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=1),
            np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=1),
            np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1),
        ],
        axis=1,
    )
