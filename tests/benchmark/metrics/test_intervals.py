"""Intervals agree with those of SciPy, and hold what they promise."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy.stats

from benchmark.metrics.intervals import median_interval, share_interval


@pytest.mark.parametrize("count", [6, 7, 9, 12, 33, 48, 51, 100])
@pytest.mark.parametrize("level", [0.9, 0.95])
def test_the_interval_of_a_median_is_that_of_a_quantile_test(count: int, level: float) -> None:
    values = np.random.default_rng(count).lognormal(size=count)
    theirs: Any = scipy.stats.quantile_test(values, p=0.5).confidence_interval(level)
    assert median_interval(values.tolist(), level) == (theirs.low, theirs.high)


def test_few_values_do_not_bound_a_median() -> None:
    assert median_interval([1.0, 2.0, 3.0, 4.0, 5.0]) == (-math.inf, math.inf)
    assert median_interval([1.0] * 5 + [math.inf]) == (1.0, math.inf)


@pytest.mark.parametrize(("count", "of"), [(0, 5), (3, 7), (7, 7), (11, 29), (28, 48)])
def test_the_interval_of_a_share_is_the_exact_one(count: int, of: int) -> None:
    theirs = scipy.stats.binomtest(count, of).proportion_ci(0.95, method="exact")
    assert share_interval(count, of) == pytest.approx((theirs.low, theirs.high), abs=1e-9)


def test_the_median_lies_in_its_interval_as_often_as_promised() -> None:
    rng = np.random.default_rng(52)
    held = 0
    for _ in range(2000):
        low, high = median_interval(rng.exponential(size=25).tolist())
        held += low <= math.log(2.0) <= high
    assert held >= 0.94 * 2000


@pytest.mark.parametrize("values", [[], [1.0, math.nan]])
def test_nothing_has_no_interval(values: list[float]) -> None:
    with pytest.raises(ValueError, match="at least one value"):
        median_interval(values)


@pytest.mark.parametrize(("count", "of"), [(-1, 4), (5, 4), (0, 0)])
def test_no_share_of_more_than_there_are(count: int, of: int) -> None:
    with pytest.raises(ValueError, match="expected 0 to"):
        share_interval(count, of)
