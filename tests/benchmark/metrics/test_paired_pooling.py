"""Spreads of methods that scatter hardly more than by chance are taken as one."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import special, stats

from benchmark.metrics.paired import EQUIVALENT, LEVEL, POWER, smallest_ratio

UNITS, METHODS = 8, 11
#: Variance of the logarithm of a variance of seven degrees of freedom, by chance alone.
CHANCE = float(special.polygamma(1, (UNITS - 1) / 2.0))


def ratio(beyond_chance: float) -> tuple[float, float]:
    """Smallest ratio of methods whose log variances scatter so much, and that of one spread."""
    steps = stats.zscore(stats.norm.ppf((np.arange(METHODS) + 0.5) / METHODS), ddof=1)
    spreads = 0.03 * np.exp(0.5 * math.sqrt(CHANCE + beyond_chance) * steps)
    shape = stats.zscore([3.0, -1.0, 2.0, 0.0, -2.0, 1.0, -4.0, 1.0], ddof=1)
    logs = np.vstack([np.zeros(UNITS), spreads[:, None] * shape])
    half = (UNITS - 1) / 2.0
    common = math.exp(np.mean(2.0 * np.log(spreads)) - special.digamma(half) + math.log(half))
    # of as many degrees of freedom as a normal distribution has
    needed = stats.norm.ppf(1.0 - LEVEL / ((METHODS + 1) * METHODS)) + stats.norm.ppf(POWER)
    pooled = EQUIVALENT * math.exp(needed * math.sqrt(common / UNITS))
    found = smallest_ratio(logs, 0)
    assert found is not None
    return found, pooled


@pytest.mark.parametrize("beyond_chance", [-1e-2, -1e-9, 1e-9, 9e-7])
def test_spreads_that_scatter_by_chance_are_one(beyond_chance: float) -> None:
    found, pooled = ratio(beyond_chance)
    assert found == pytest.approx(pooled, rel=1e-5)


def test_spreads_that_scatter_by_more_keep_some_of_their_own() -> None:
    found, pooled = ratio(0.5)
    assert found > 1.001 * pooled
