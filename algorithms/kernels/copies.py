"""Copies of arrays into arrays of the same shape, for kernels.

Numba compiles ``out[:] = source`` with the message for unlike shapes, which takes seconds in every
kernel that does so, and in those that call it.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from algorithms.compiled import compiled


@compiled
def copy_row(source: NDArray[Any], out: NDArray[Any]) -> None:
    """Write an array (n,) to another (n,)."""
    for i in range(out.shape[0]):
        out[i] = source[i]


@compiled
def copy_matrix(source: NDArray[Any], out: NDArray[Any]) -> None:
    """Write an array (m, n) to another (m, n)."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = source[i, j]
