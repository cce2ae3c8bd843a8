"""`Track`: what a filter makes of a sequence of samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats


@dataclass(frozen=True)
class Track:
    """What a filter makes of samples, row by row.

    Attributes
    ----------
    sun : ndarray, shape (N, 3)
        Unit vectors, dead reckoning where nothing is read; NaN before a series' first reading.
    deviation_deg : ndarray, shape (N,)
        1-sigma of a tangent axis.
    is_read : ndarray of bool, shape (N,)
        Whether the row's features were used.
    squared_innovation : ndarray, shape (N,)
        In units of its covariance; NaN where nothing was read, and at a series' start.
    series : ndarray of int, shape (N,)
        Number of the row's series, from 0.
    drift : ndarray, shape (N, p)
        The sensor's parameters in the state.
    drift_deviation : ndarray, shape (N, p)
        Their 1-sigma.
    bias_deg_h : ndarray, shape (N, 3)
        Of the gyroscope.
    """

    sun: Floats
    deviation_deg: Floats
    is_read: NDArray[np.bool_]
    squared_innovation: Floats
    series: NDArray[np.int64]
    drift: Floats
    drift_deviation: Floats
    bias_deg_h: Floats
