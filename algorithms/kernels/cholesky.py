"""Symmetric equations by Cholesky's factor, in place."""

from __future__ import annotations

import math

from algorithms.compiled import compiled
from algorithms.contract import Floats


@compiled
def factor(matrix: Floats, least: float) -> bool:
    """Replace the lower half of a symmetric matrix by its factor; its upper half is not read.

    False, and the factor is of no use, where a pivot is not more than `least` of its diagonal: what
    depends on the others as nearly as that is not determined.
    """
    for i in range(matrix.shape[0]):
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            if i > j:
                matrix[i, j] = total / matrix[j, j]
            elif total > least * matrix[i, i]:
                matrix[i, i] = math.sqrt(total)
            else:
                return False
    return True


@compiled
def forward(root: Floats, vector: Floats) -> None:
    """Solve ``L x = vector`` in place; L is the lower half of `root`."""
    for i in range(vector.size):
        total = vector[i]
        for k in range(i):
            total -= root[i, k] * vector[k]
        vector[i] = total / root[i, i]


@compiled
def backward(root: Floats, vector: Floats) -> None:
    """Solve ``L' x = vector`` in place; L is the lower half of `root`."""
    for i in range(vector.size - 1, -1, -1):
        total = vector[i]
        for k in range(i + 1, vector.size):
            total -= root[k, i] * vector[k]
        vector[i] = total / root[i, i]


@compiled
def solve(matrix: Floats, vector: Floats, least: float) -> bool:
    """Solve ``matrix x = vector``; both are used up. False where `factor` is."""
    if not factor(matrix, least):
        return False
    forward(matrix, vector)
    backward(matrix, vector)
    return True
