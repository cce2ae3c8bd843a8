"""Limits within which a network answers, set by clean frames of units that are not scored."""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats

#: Share of clean frames beyond each limit of a statistic.
_BEYOND = 0.005
#: Limits are wider than that by so much of the range between them, and by so much at least.
_WIDER, _LEAST = 0.25, 0.05


def limits_of(statistics: Floats) -> list[list[float]]:
    """Return (low, high) of each column of statistics (N, K) of clean frames."""
    low, high = np.quantile(statistics, [_BEYOND, 1.0 - _BEYOND], axis=0)
    wider = np.maximum(_WIDER * (high - low), _LEAST)
    return [[float(value) for value in pair] for pair in np.round([low - wider, high + wider], 4).T]
