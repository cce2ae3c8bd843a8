"""Requirements at a confidence against drawn units and benches, and closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from registry.draws import (
    BENCHES,
    at_confidence,
    bench_for,
    unit_errors,
    unit_ratios,
)

ALIKE = (1.0,) * 10


def one_at_confidence(own, ratios, bench, share):
    return at_confidence(np.array([own]), np.array([ratios]), bench, share)[0]


@settings(deadline=None, derandomize=True)
@given(own=st.floats(1e-4, 1.0), share=st.floats(0.5, 0.999))
def test_units_alike_on_a_perfect_bench_err_what_they_err(own, share):
    assert one_at_confidence(own, ALIKE, 0.0, share) == pytest.approx(own, rel=1e-12)


@settings(deadline=None, derandomize=True)
@given(
    own=st.floats(1e-4, 0.1),
    bench=st.floats(0.0, 0.1),
    spread=st.floats(0.0, 0.5),
    share=st.sampled_from([0.5, 0.8, 0.9, 0.95]),
)
def test_the_error_is_the_smallest_that_so_many_draws_keep_within(own, bench, spread, share):
    ratios = unit_ratios((own,), spread)
    found = one_at_confidence(own, ratios, bench, share)
    draws = [math.hypot(own * r, bench * b) for r in ratios for b in BENCHES]
    keeping = sum(draw <= found * (1 + 1e-12) for draw in draws)
    below = sum(draw < found * (1 - 1e-12) for draw in draws)
    assert below < share * len(draws) <= keeping + 1e-9


@pytest.mark.parametrize("share", [0.5, 0.9, 0.93, 0.999])
def test_each_unit_keeps_the_smallest_error_on_so_many_of_the_benches(share):
    own, bench = np.array([0.01, np.inf]), 0.03
    ratios = np.array([unit_ratios((1.0,), 0.3)] * 2)
    found, nothing = unit_errors(own, ratios, bench, share)
    assert np.isinf(nothing).all()
    for error, ratio in zip(found, ratios[0], strict=True):
        draws = np.hypot(own[0] * ratio, bench * np.array(BENCHES))
        enough = [draw for draw in draws if np.mean(draws <= draw) >= share - 1e-9]
        assert error == pytest.approx(min(enough), rel=1e-12)


def test_ratios_of_measured_units_are_theirs_and_of_few_those_of_the_spread():
    errors = [0.9, 1.1, 1.0, 1.2, 0.8, 1.05, 0.95, 1.0, 1.3, 0.7]
    ratios = np.array(unit_ratios(errors, 99.0))
    middle = np.exp(np.mean(np.log(errors)))
    np.testing.assert_allclose(ratios, np.sort(errors) / middle)
    few = np.log(unit_ratios((0.5,), 0.2))
    assert few.mean() == pytest.approx(0.0, abs=1e-12)
    assert few.std() == pytest.approx(0.2, rel=0.1)


def test_the_bench_that_would_do_does_and_a_worse_one_does_not():
    own = np.array([0.006, 0.0099, 0.02])
    ratios = np.array([unit_ratios((1.0,), spread) for spread in (0.1, 0.02, 0.1)])
    for share in (0.5, 0.9, 0.95):
        bench = bench_for(own, ratios, 0.01, share)
        for at in np.flatnonzero(bench):
            pair = own[at], ratios[at]
            assert one_at_confidence(*pair, (1 - 1e-9) * bench[at], share) <= 0.01
            assert one_at_confidence(*pair, (1 + 1e-9) * bench[at], share) > 0.01
    assert bench[0] > 0.0
    assert bench[2] == 0.0


def test_of_what_is_said_to_meet_a_limit_fresh_units_and_benches_do():
    """A hundred drawn limits; pipelines measured on ten units, the bench's errors as tabulated."""
    rng = np.random.default_rng(20261125)
    met = []
    for _ in range(100):
        own, spread, bench = 10 ** rng.uniform(-3, -1), rng.uniform(0.01, 0.15), 0.0158
        units = own * np.exp(spread * rng.standard_normal(10))
        ratios = unit_ratios(tuple(units), spread)
        middle = float(np.exp(np.mean(np.log(units))))
        limit = middle * 10 ** rng.uniform(-0.2, 0.8) + rng.uniform(0, 0.03)
        if one_at_confidence(middle, ratios, bench, 0.9) <= limit:
            fresh = own * np.exp(spread * rng.standard_normal(400))
            drawn = bench * np.interp(rng.random(400), (np.arange(20) + 0.5) / 20, BENCHES)
            met.append(np.mean(np.hypot(fresh, drawn) <= limit))
    assert len(met) > 30
    assert np.mean(met) > 0.9
    assert np.mean(np.array(met) >= 0.85) > 0.95
