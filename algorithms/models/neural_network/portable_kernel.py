"""Angles of tangents and products of designs, the same to the last bit on every processor."""

from __future__ import annotations

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats


@compiled
def angles_deg(tangents: Floats, out: Floats) -> None:
    """Angles (N,) of tangents (N,), degrees, into `out`: three halvings, then the series."""
    for i in range(len(tangents)):
        t = tangents[i]
        for _ in range(3):
            t = t / (1.0 + np.sqrt(1.0 + t * t))
        square = t * t
        value = 0.0
        for odd in range(29, 0, -2):
            value = 1.0 / odd - square * value
        out[i] = 8.0 * t * value * (180.0 / np.pi)


@compiled
def products(design: Floats, wanted: Floats, normal: Floats, right: Floats) -> None:
    """Mean products of a design (n, P) with itself (P, P; upper) and with `wanted` (n,) (P,)."""
    normal[:] = 0.0
    right[:] = 0.0
    count, terms = design.shape
    for i in range(count):
        for p in range(terms):
            right[p] += design[i, p] * wanted[i] / count
            for q in range(p, terms):
                normal[p, q] += design[i, p] * design[i, q] / count
