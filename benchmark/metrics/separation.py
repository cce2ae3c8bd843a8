"""Angles between directions, and numbers as results keep them: data depend on these, too."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import Floats

SIGNIFICANT_DIGITS = 5
_FEWEST_ALIGNED = 3


def store(value: float, digits: int = SIGNIFICANT_DIGITS) -> float | None:
    """Round a number as results keep it, to significant digits; None where it is not finite."""
    return float(f"{value:.{digits}g}") if math.isfinite(value) else None


def separation_deg(first: ArrayLike, second: ArrayLike) -> Floats:
    """Angle (N,) in degrees between unit vectors (N, 3); exact for tiny angles, NaN for NaN rows.

    The arc tangent of ``|a x b|`` over ``a . b``: the arc cosine loses all below 1e-6 degrees.
    """
    a = np.asarray(first, dtype=np.float64)
    b = np.asarray(second, dtype=np.float64)
    cross = np.cross(a, b)
    along = np.einsum("ij,ij->i", a, b)
    angle: Floats = np.degrees(np.arctan2(np.sqrt(np.einsum("ij,ij->i", cross, cross)), along))
    return angle


def aligned_error_deg(predicted: ArrayLike, sun: ArrayLike) -> Floats:
    """Errors (N,) in degrees that the best rotation leaves, as an alignment in flight does.

    The rotation is the one that least squares give (Wahba's problem, by singular values); of fewer
    than three directions it is unknown, and errors stay what they are.

    Parameters
    ----------
    predicted, sun
        Unit vectors (N, 3).
    """
    p, s = np.asarray(predicted, np.float64), np.asarray(sun, np.float64)
    if len(p) < _FEWEST_ALIGNED:
        return separation_deg(p, s)
    u, _, vt = np.linalg.svd(s.T @ p)
    turn = u @ np.diag([1.0, 1.0, float(np.sign(np.linalg.det(u) * np.linalg.det(vt)))]) @ vt
    return separation_deg(p @ turn.T, s)
