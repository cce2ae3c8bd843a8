"""Trials of a statistic become a verdict: Student's interval against the limit, no more."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from benchmark.claims.judgement import judge, verdict
from benchmark.claims.rules import Rule


def rule(relation, limit, upper=math.nan, scale="linear"):
    return Rule("r", "something", scale, relation, limit, upper, timed=False)


@given(st.lists(st.floats(-1e3, 1e3), min_size=5, max_size=12))
def test_the_interval_is_scipys(values):
    found = judge(rule(">", 0.0), values)
    mean, sem = np.mean(values), stats.sem(values)
    assert found.estimate == pytest.approx(mean)
    if sem > 1e-9:
        low, high = stats.t.interval(0.95, len(values) - 1, mean, sem)
        assert (found.low, found.high) == pytest.approx((low, high), rel=1e-6, abs=1e-6)


@given(st.lists(st.floats(1e-3, 1e3), min_size=5, max_size=12), st.floats(0.1, 10.0))
def test_ratios_are_averaged_so_that_turning_them_over_turns_the_verdict_over(values, limit):
    one = judge(rule(">", limit, scale="log"), values)
    other = judge(rule("<", 1.0 / limit, scale="log"), [1.0 / value for value in values])
    assert other.estimate == pytest.approx(1.0 / one.estimate)
    near = min(abs(math.log(one.low / limit)), abs(math.log(one.high / limit)))
    if near > 1e-9:
        assert one.result == other.result


@pytest.mark.parametrize(
    ("relation", "values", "result"),
    [
        (">", [2.0, 2.1, 1.9, 2.0, 2.05], "holds"),
        (">", [0.5, 0.6, 0.4, 0.5, 0.55], "fails"),
        (">", [0.5, 1.6, 0.9, 1.2, 1.05], "open"),
        ("<", [0.5, 0.6, 0.4, 0.5, 0.55], "holds"),
        ("<=", [1.0, 1.0, 1.0, 1.0, 1.0], "holds"),
        ("<", [1.0, 1.0, 1.0, 1.0, 1.0], "fails"),
        (">=", [1.0, 1.0, 1.0, 1.0, 1.0], "holds"),
        (">", [1.0, 1.0, 1.0, 1.0, 1.0], "fails"),
    ],
)
def test_a_rule_holds_where_the_whole_interval_keeps_the_limit(relation, values, result):
    assert judge(rule(relation, 1.0), values).result == result


def test_within_needs_both_ends():
    within = rule("within", -0.6, -0.4)
    assert judge(within, [-0.5, -0.51, -0.49, -0.5, -0.5]).result == "holds"
    assert judge(within, [-0.3, -0.31, -0.29, -0.3, -0.3]).result == "fails"
    assert judge(within, [-0.6, -0.61, -0.59, -0.6, -0.6]).result == "open"


def test_four_trials_decide_nothing_whatever_they_say():
    found = judge(rule(">", 1.0), [9.0, 9.0, math.nan, 9.0, 9.0])
    assert (found.result, found.trials) == ("open", 4)
    assert math.isnan(found.estimate)


def test_no_logarithm_of_less_than_nothing():
    with pytest.raises(ValueError, match=r"never negative; got -1"):
        judge(rule(">", 1.0, scale="log"), [1.0, 2.0, -1.0, 2.0, 1.0])


@pytest.mark.parametrize(
    ("values", "interval", "result"),
    [
        ([0.0] * 5, (0.0, 0.0), "holds"),
        ([math.inf] * 5, (math.inf, math.inf), "fails"),
        ([0.1, 0.2, 0.0, 0.1, 0.2], (0.0, math.inf), "open"),
        ([0.1, 0.2, math.inf, 0.1, 0.2], (0.0, math.inf), "open"),
    ],
)
def test_what_has_no_logarithm_decides_where_all_trials_agree(values, interval, result):
    """An error of zero, or a ratio to one, in every trial is beyond every limit."""
    found = judge(rule("<", 1.0, scale="log"), values)
    assert (found.low, found.high) == interval
    assert (found.result, found.trials) == (result, 5)


@pytest.mark.parametrize(
    ("results", "expected"),
    [
        ("hh", "reproduced"),
        ("hf", "partly"),
        ("ho", "partly"),
        ("ff", "refuted"),
        ("fo", "refuted"),
        ("oo", "not testable"),
    ],
)
def test_verdicts(results, expected):
    values = {"h": [2.0] * 5, "f": [0.5] * 5, "o": [0.1, 5.0, 0.2, 3.0, 0.4]}
    assert verdict(judge(rule(">", 1.0), values[letter]) for letter in results) == expected


def test_nothing_has_no_verdict():
    with pytest.raises(ValueError, match="at least one"):
        verdict([])
