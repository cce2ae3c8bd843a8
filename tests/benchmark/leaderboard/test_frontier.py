"""The frontier of error and cost, against brute force and units whose order is known."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark.leaderboard.frontier import frontier

UNITS = 10


def test_the_frontier_is_what_nothing_beats_in_both() -> None:
    random = np.random.default_rng(20261130)
    for count in (1, 2, 7, 40):
        errors = random.integers(1, 12, count).astype(float)
        costs = random.integers(1, 12, count).astype(float)
        found = frontier(list(errors), list(costs), [[error] for error in errors])
        for at in range(count):
            no_worse = (errors <= errors[at]) & (costs <= costs[at])
            beaten = (no_worse & ((errors < errors[at]) | (costs < costs[at]))).any()
            assert found[at] == ("untested" if beaten else "frontier")


def test_what_is_behind_is_dominated_where_all_units_say_so() -> None:
    random = np.random.default_rng(1)
    hard = np.exp(0.3 * random.standard_normal(UNITS))  # of a unit, the same for all
    noise = np.exp(0.02 * random.standard_normal((4, UNITS)))
    units = [hard * 1.0 * noise[0], hard * 2.0 * noise[1], hard * 1.001 * noise[2]]
    units.append(hard[:4] * 2.0 * noise[3][:4])
    errors = [1.0, 2.0, 1.001, 2.0]
    found = frontier(errors, [1.0, 2.0, 2.0, 2.0], [list(map(float, one)) for one in units])
    assert found == ["frontier", "dominated", "not separable", "untested"]


def test_a_cheaper_pipeline_is_compared_with_what_costs_no_more() -> None:
    errors = [1.0, 3.0, 6.0]
    units: list[list[float | None]] = [
        [error * (1 + 0.01 * (n % 3)) for n in range(UNITS)] for error in errors
    ]
    # the third errs twice as much as the second, which is no cheaper than it
    assert frontier(errors, [9.0, 2.0, 2.0], units) == ["frontier", "frontier", "dominated"]


def test_lists_of_different_length_are_refused() -> None:
    with pytest.raises(ValueError, match="as many"):
        frontier([1.0], [1.0, 2.0], [[1.0]])
