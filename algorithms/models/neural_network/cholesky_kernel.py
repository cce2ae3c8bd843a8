"""Linear equations of a positive definite matrix, solved alike to the last bit everywhere.

Blocked, which `algorithms.kernels.cholesky` is not: 3 times as fast with the 121 weights of a
network, whose training spends most of its time here.
"""

from __future__ import annotations

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.copies import copy_row

_PIVOTS = 4
"""Rows of the factor that are taken from those below in one pass; the code names each of them."""


@compiled
def solve(normal: Floats, added: float, wanted: Floats, factor: Floats, out: Floats) -> bool:
    """Solve ``(normal + added I) out = wanted`` by Cholesky's factor; whether it could be.

    Parameters
    ----------
    normal : ndarray, shape (P, P)
        Symmetric; only its upper triangle is read.
    added : float
        To the diagonal.
    wanted : ndarray, shape (P,)
        Right-hand side.
    factor : ndarray, shape (P, P)
        Overwritten: U with ``U' U`` the matrix, in the upper triangle.
    out : ndarray, shape (P,)
        Overwritten.
    """
    count = len(wanted)
    for p in range(count):
        copy_row(normal[p, p:], factor[p, p:])
        factor[p, p] += added
        out[p] = wanted[p]
    for first in range(0, count, _PIVOTS):
        last = min(first + _PIVOTS, count)
        if not _eliminate(factor, out, first, last):
            return False
        if last < count:
            _take_four(factor, out, first)
    for p in range(count - 1, -1, -1):
        value = out[p]
        for q in range(p + 1, count):
            value -= factor[p, q] * out[q]
        out[p] = value / factor[p, p]
    return True


@compiled
def _eliminate(factor: Floats, out: Floats, first: int, last: int) -> bool:
    """Make some rows those of the factor, from the first on; False for a pivot that is not > 0."""
    for p in range(first, last):
        pivot = factor[p, p]
        if not pivot > 0.0:
            return False
        root = np.sqrt(pivot)
        factor[p, p:] /= root
        out[p] /= root
        for r in range(p + 1, last):
            share = factor[p, r]
            # sliced: contiguous for the compiler
            line, above = factor[r, r:], factor[p, r:]
            for q in range(len(line)):
                line[q] -= share * above[q]
            out[r] -= share * out[p]
    return True


@compiled
def _take_four(factor: Floats, out: Floats, first: int) -> None:
    """Take four rows of the factor from all rows below, one product after the other."""
    second, third, fourth = first + 1, first + 2, first + 3
    for r in range(first + _PIVOTS, len(out)):
        line, row, row1 = factor[r, r:], factor[first, r:], factor[second, r:]
        row2, row3 = factor[third, r:], factor[fourth, r:]
        a, b, c, d = row[0], row1[0], row2[0], row3[0]
        for q in range(len(line)):
            line[q] = line[q] - a * row[q] - b * row1[q] - c * row2[q] - d * row3[q]
        out[r] = out[r] - a * out[first] - b * out[second] - c * out[third] - d * out[fourth]
