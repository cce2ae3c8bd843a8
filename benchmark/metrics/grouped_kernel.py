"""Compiled products of readings with what their groups share (loaded on first use: Numba)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Groups = NDArray[np.int64]


@compiled
def products(out: Floats, groups: Groups, loading: Floats, vectors: Floats) -> None:
    """Add to (N, G) the products of vectors (N, M) with each group's part of `loading` (N, M).

    `groups` (N, M) says in which group each element is.
    """
    for n in range(groups.shape[0]):
        for m in range(groups.shape[1]):
            out[n, groups[n, m]] += loading[n, m] * vectors[n, m]


@compiled
def add_along(vectors: Floats, groups: Groups, loading: Floats, shares: Floats) -> None:
    """Add each group's share (N, G) of `loading` (N, M) to vectors (N, M)."""
    for n in range(groups.shape[0]):
        for m in range(groups.shape[1]):
            vectors[n, m] += loading[n, m] * shares[n, groups[n, m]]
