"""Means over the sensors or conditions of one trial."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def geometric(values: Sequence[float]) -> float:
    """Geometric mean; NaN where one of them is."""
    return float(np.exp(np.mean(np.log(values))))
