"""Methods distinguished by a paired test: simulated boards of known truth are the oracle."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy import optimize, special, stats

from benchmark.metrics.paired import (
    EQUIVALENT,
    LEVEL,
    POWER,
    groups,
    logarithms,
    over,
    separate,
    smallest_ratio,
)

METHODS, UNITS, BOARDS = 20, 10, 400


def boards(seed, spread, shared=0.0, ratios=None, *, uneven=0.0):
    """Give log errors of boards: units differ, methods of one family share part of their luck."""
    rng = np.random.default_rng(seed)
    for _ in range(BOARDS):
        unit = rng.normal(0.0, 0.3, (1, UNITS))
        own = rng.normal(size=(METHODS, UNITS))
        family = np.repeat(rng.normal(size=(METHODS // 4, UNITS)), 4, axis=0)
        scale = spread * np.exp(uneven * rng.normal(size=(METHODS, 1)))
        luck = scale * (math.sqrt(1.0 - shared) * own + math.sqrt(shared) * family)
        yield unit + luck + np.log(np.ones(METHODS) if ratios is None else ratios)[:, None]


def leader(logs):
    return int(np.argmin(logs.mean(axis=1)))


@pytest.mark.parametrize(
    "spread", [0.01, *(pytest.param(s, marks=pytest.mark.slow) for s in (0.03, 0.1)), 0.3]
)
@pytest.mark.parametrize(("shared", "uneven"), [(0.0, 0.0), (0.5, 0.0), (0.9, 0.0), (0.0, 0.5)])
def test_of_twenty_equal_methods_one_is_separated_on_at_most_one_board_in_twenty(
    spread, shared, uneven
):
    """At most 5 %: more than 5 % of 400 boards by what chance does to a true 5 % is a failure."""
    falsely = sum(
        separate(logs, leader(logs)).any() for logs in boards(1, spread, shared, uneven=uneven)
    )
    assert falsely <= stats.binom.ppf(0.99, BOARDS, LEVEL)


def test_counting_the_comparisons_with_the_leader_alone_would_not_hold():
    """Why all pairs are counted: plain Holm (19 comparisons) errs on far more boards."""
    falsely = 0
    for logs in boards(2, 0.3):
        ratio = np.delete(logs - logs[leader(logs)], leader(logs), axis=0)
        t = (ratio.mean(axis=1) - math.log(EQUIVALENT)) / (
            math.sqrt(ratio.var(axis=1, ddof=1).mean() / UNITS)
        )
        falsely += stats.t.sf(t.max(), 9 * 19) < LEVEL / 19
    assert falsely > 3 * LEVEL * BOARDS


#: 1.4 to 4.2 % between two methods.
@pytest.mark.parametrize(
    "spread", [*(pytest.param(s, marks=pytest.mark.slow) for s in (0.01, 0.02)), 0.03]
)
@pytest.mark.parametrize("shared", [0.0, 0.5])
def test_a_difference_of_ten_percent_is_told_apart(spread, shared):
    """One method worse than the nineteen others, and one better than they are."""
    ratios = np.ones(METHODS)
    ratios[7] = 1.1
    found = [separate(logs, leader(logs)) for logs in boards(3, spread, shared, ratios)]
    assert np.mean([apart[7] for apart in found]) >= 0.9
    assert np.mean([np.delete(apart, 7).any() for apart in found]) <= LEVEL
    found = [separate(logs, leader(logs)) for logs in boards(4, spread, shared, 1.1 / ratios)]
    assert np.mean([apart.sum() for apart in found]) >= 0.9 * (METHODS - 1)


@pytest.mark.parametrize("spread", [0.01, 0.05, 0.2])
def test_the_smallest_ratio_is_told_apart_in_nine_cases_of_ten(spread):
    ratio = np.median([smallest_ratio(logs, leader(logs)) for logs in boards(5, spread)])
    ratios = np.ones(METHODS)
    ratios[3] = ratio
    found = [separate(logs, 0)[3] for logs in boards(6, spread, ratios=ratios)]
    assert 0.83 <= np.mean(found) <= 0.97


def test_methods_that_differ_by_less_than_three_percent_are_one_group():
    logs = logarithms([[1.0] * 10, [1.029] * 10, [1.05] * 10])
    assert groups(logs, 0) == [1, 1, 2]


def test_groups_follow_each_other_and_what_has_few_units_has_none():
    logs = logarithms(
        [
            [1.0, 2.0, 4.0, 3.0, 2.0, 1.0],
            [2.0, 4.0, 8.0, 6.0, 4.0],
            [9.0],
            [4.0, 8.0, 16.0, 12.0, 8.0],
        ]
    )
    assert groups(logs, 0) == [1, 2, None, 3]
    np.testing.assert_allclose(over(logs, 0), [1.0, 2.0, 9.0, 4.0])


def test_units_are_paired():
    """Ranges overlap wholly, yet one errs a tenth more on every unit."""
    first = [1.0, 3.0, 2.0, 5.0, 1.5, 2.5, 4.0, 1.2, 3.3, 2.2]
    assert groups(logarithms([first, [1.1 * error for error in first]]), 0) == [1, 2]


def test_a_unit_without_an_error_is_left_out():
    logs = logarithms([[1.0] * 6, [2.0, None, 2.0, 2.0, 2.0, 2.0], [2.0, None, None, 2.0, 2.0]])
    assert groups(logs, 0) == [1, 2, None]


def test_a_method_is_not_told_apart_from_itself_nor_is_one_alone():
    logs = logarithms([[0.0] * 5])
    assert groups(logs, 0) == [1]
    assert smallest_ratio(logs, 0) is None
    assert groups(logarithms([[0.0] * 5, [0.0] * 5]), 0) == [1, 1]


def test_more_units_tell_smaller_ratios_apart():
    rng = np.random.default_rng(8)
    logs = rng.normal(0.0, 0.03, (5, 40))
    ratio = [smallest_ratio(logs[:, :n], 0) for n in (5, 10, 20, 40)]
    assert all(later < earlier for earlier, later in pairwise(ratio))
    assert min(ratio) > EQUIVALENT


def moderated(spread, freedom):
    """Standard deviations and freedom of limma's `squeezeVar`: its equations solved by bisection.

    A scaled F distribution is fitted to the variances by the mean and variance of their logarithms.
    """
    logs = 2.0 * np.log(spread) - special.digamma(freedom / 2) + math.log(freedom / 2)
    excess = np.var(logs, ddof=1) - special.polygamma(1, freedom / 2)
    prior = 2.0 * optimize.brentq(
        lambda half: special.polygamma(1, half) - excess, 1e-3, 1e6, xtol=1e-14, rtol=1e-14
    )
    common = math.exp(np.mean(logs) + special.digamma(prior / 2) - math.log(prior / 2))
    variance = (prior * common + freedom * spread**2) / (prior + freedom)
    return np.sqrt(variance), prior + freedom


@pytest.mark.parametrize("scatter", [0.6, 1.2])  # priors of 2.7 and 1.0 degrees of freedom
def test_variances_are_drawn_together_as_limma_does(scatter):
    """Methods whose log ratios to the leader spread by what was chosen, exactly."""
    chosen = 0.03 * np.exp(scatter * stats.norm.ppf((np.arange(11) + 0.5) / 11))
    shape = stats.zscore([3.0, -1.0, 2.0, 0.0, -2.0, 1.0, -4.0, 1.0], ddof=1)
    logs = np.vstack([np.zeros(8), chosen[:, None] * shape])
    sd, freedom = moderated(chosen, 7)
    methods = len(logs)  # all of them are beside the leader: their mean log ratio is nothing
    needed = stats.t.ppf(1 - LEVEL / (methods * (methods - 1)), freedom)
    needed += stats.t.ppf(POWER, freedom)
    expected = EQUIVALENT * math.exp(needed * np.median(sd) / math.sqrt(8))
    assert smallest_ratio(logs, 0) == pytest.approx(expected, rel=1e-9)
    assert not separate(logs, 0).any()
