"""Row-wise arithmetic that turns a row without a meaning into NaN, quietly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def quotient_rows(numerators: Floats, divisors: Floats, valid: NDArray[np.bool_]) -> Floats:
    """Rows (N, F) over their divisor (N,); a NaN row where not `valid` (N,)."""
    quotients = np.full_like(numerators, np.nan)
    np.divide(numerators, divisors[:, None], out=quotients, where=valid[:, None])
    return quotients


def normalised(vectors: Floats) -> Floats:
    """Rows scaled to unit length; a NaN row where the length is zero or not finite."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit = np.full_like(vectors, np.nan)
    np.divide(vectors, length, out=unit, where=np.isfinite(length) & (length > 0))
    return unit
