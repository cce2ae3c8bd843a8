"""Requirements at a confidence against drawn units and benches, and closed forms."""

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from registry.draws import (
    BENCHES,
    bench_for,
    largest_bench,
    one_at_confidence,
    unit_errors,
    unit_ratios,
)
from registry.measured_pipelines import MeasuredPipeline, Score
from registry.recommendation import recommend

ALIKE = (1.0,) * 10


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
    own, bench = np.array([0.01, np.inf]), np.array([0.03, 0.03])
    ratios = np.array([unit_ratios((1.0,), 0.3)] * 2)
    found, nothing = unit_errors(own, ratios, bench, share)
    assert np.isinf(nothing).all()
    for error, ratio in zip(found, ratios[0], strict=True):
        draws = np.hypot(own[0] * ratio, bench[0] * np.array(BENCHES))
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


@settings(deadline=None, derandomize=True)
@given(
    pipelines=st.lists(
        st.tuples(st.floats(1e-4, 0.05), st.lists(st.floats(0.1, 3.0), min_size=10, max_size=10)),
        min_size=1,
        max_size=6,
    ),
    limit=st.floats(1e-4, 0.1),
    share=st.floats(0.5, 0.999),
)
def test_the_largest_bench_is_the_largest_of_all(pipelines, limit, share):
    own = np.array([error for error, _ in pipelines])
    ratios = np.array([units for _, units in pipelines])
    found = largest_bench(own, ratios, limit, share)
    assert found == bench_for(own, ratios, limit, share).max()


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


def pipeline(name, own, **more):
    row = {
        "dataset": name,
        "detector": "CMOS",
        "mask": "Single-Ap.",
        "extractor": "e",
        "extractor_taxonomy": "BCTM",
        "model": "m",
        "stages": ("SPM",),
        "nominal": Score("nominal", own, availability=1.0),
        "half_fov_deg": 60.0,
        "unit_own_deg": (own,) * 10,
        "bench_deg": 0.0158,
    }
    return MeasuredPipeline(**{**row, **more})


def test_an_error_is_judged_on_the_bench_asked_for_and_one_that_would_do_is_named():
    row = pipeline("a", 0.004)

    def measured(**asked):
        answer = recommend({"max_error_deg": 0.01, "mask": "Single-Ap.", **asked}, [row])
        return [a.best.measured for a in answer.architectures if a.best.measured]

    assert [one["units"]["within_limit"] for one in measured(bench_deg=0.0)] == [10]
    assert [one["units"]["within_limit"] for one in measured(bench_deg=0.002)] == [10]
    assert measured() == []
    only = {"max_error_deg": 0.0042, "detector": "CMOS", "mask": "Single-Ap.", "survive": []}
    assert row.judge(draws=(None, 0.9)).error_deg > 0.0158
    blocked = recommend({**only, "min_availability": 0.5}, [row]).blocking_constraint
    assert blocked is not None
    assert "bench good to" in blocked.detail


def test_units_within_a_limit_are_counted_for_each_calibration_of_an_architecture():
    rows = [
        pipeline(
            "a",
            own,
            model=model,
            stages=(model,),
            unit_own_deg=(own,) * within + (0.5,) * (10 - within),
            unit_ratios=(1.0,) * within + (0.5 / own,) * (10 - within),
        )
        for own, model, within in ((0.003, "SPM", 9), (0.0035, "Linear", 10), (0.004, "ANN", 9))
    ]
    answer = recommend({"max_error_deg": 0.01, "mask": "Single-Ap.", "bench_deg": 0.0}, rows)
    (place,) = (one for one in answer.architectures if one.best.measured)
    found = {
        one.model: one.measured["units"]["within_limit"]
        for one in place.calibrations
        if one.measured
    }
    assert found == {"SPM": 9, "Linear": 10, "ANN": 9}


@pytest.mark.parametrize(("own", "over"), [(0.004, 1.3), (0.004, 1.5), (0.0333, 2.2)])
def test_the_bench_named_would_do_and_one_a_tenth_worse_would_not(own, over):
    rows = [pipeline("a", own, bench_deg=1.0)]
    only = {"mask": "Single-Ap.", "detector": "CMOS", "min_availability": 0.5}
    asked = {"max_error_deg": over * own, **only}
    blocked = recommend(asked, rows).blocking_constraint
    assert blocked is not None
    named = re.search(r"bench good to (\S+) deg would do", blocked.detail)
    assert named is not None
    counts = [
        recommend({**asked, "bench_deg": times * float(named[1])}, rows).count
        for times in (1.0, 1.11)
    ]
    assert counts == [1, 0]


def test_what_a_calibration_reads_can_be_excluded():
    rows = [pipeline("a", 0.004, needs=("rates", "time")), pipeline("b", 0.4)]
    free = recommend({"exclude_needs": ["rates"], "bench_deg": 0.0}, rows, sort="measured")
    assert free.architectures[0].best.measured["dataset"] == "b"
    asked = recommend({"bench_deg": 0.0}, rows, sort="measured")
    assert asked.architectures[0].best.measured["dataset"] == "a"
