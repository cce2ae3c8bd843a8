"""Ranks by own error over units, and groups of what is not distinguished."""

import math

import numpy as np
import pytest

from benchmark.contract import Cell
from benchmark.leaderboard.board import expected_on_bench, on_bench, twins_of
from benchmark.metrics.ranking import UnitErrors, order, rank_board
from benchmark.metrics.score import METRICS


def row(model, charged, *, unit=0, condition="nominal", **more):
    return {
        "dataset": "d", "condition": condition, "extractor": "e", "model": model, "unit": unit,
        **dict.fromkeys(METRICS), "rms_deg": charged, "rms_all_answers_deg": charged,
        "availability": 1.0, **more,
    }  # fmt: skip


def board(**errors):
    """Judge pipelines by their errors on units; several availabilities by a tuple at the end."""
    rows = [row(model, units[0]) for model, units in errors.items()]
    found = rank_board(rows, [UnitErrors(tuple(units)) for units in errors.values()])
    return {model: found.places[at] for at, model in enumerate(errors)}, found


def units(middle, spread, seed, count=10):
    return middle * np.exp(spread * np.random.default_rng(seed).standard_normal(count))


def test_own_error_is_the_geometric_mean_over_units_with_its_standard_error():
    spread = UnitErrors((1.0, 2.0, 4.0))
    assert spread.own_error_deg == 2.0
    assert spread.own_se == pytest.approx(math.log(2.0) / math.sqrt(3), rel=1e-4)
    assert (spread.low_deg, spread.high_deg) == (1.0, 4.0)
    assert UnitErrors((1.0, None)).low_deg is None
    assert UnitErrors((3.0,)).own_se is None


def test_units_are_paired_so_that_what_is_hard_for_all_separates_nothing_less():
    """Units differ by a factor of three, pipelines by 20 % on each of them."""
    hard = units(1.0, 0.5, 1)
    places, found = board(a=hard, b=1.2 * hard * units(1.0, 0.01, 2), c=hard * units(1.0, 0.01, 3))
    assert (places["a"].group, places["c"].group, places["b"].group) == (1, 1, 2)
    assert {places["a"].rank, places["c"].rank} == {1}
    assert (places["a"].tied, places["b"].tied) == (True, False)
    assert places["b"].rank == 3
    assert 1.03 < found.smallest_ratio < 1.2


def test_what_is_not_distinguished_is_listed_by_own_error():
    hard = units(1.0, 0.5, 1)
    _, found = board(a=1.001 * hard * units(1.0, 0.02, 2), b=0.999 * hard * units(1.0, 0.02, 3))
    own = [UnitErrors(tuple(hard * more)).own_error_deg for more in (
        1.001 * units(1.0, 0.02, 2), 0.999 * units(1.0, 0.02, 3)
    )]  # fmt: skip
    assert {place.group for place in found.places} == {1}
    assert list(found.order) == sorted((0, 1), key=own.__getitem__) == [1, 0]


def test_what_was_scored_on_one_unit_is_behind_all_groups():
    groups = {"a": units(1.0, 0.02, 1), "b": units(1.3, 0.02, 2), "c": units(1.7, 0.02, 3)}
    places, _ = board(lucky=[0.5], **groups)
    assert [places[name].rank for name in ("a", "b", "c", "lucky")] == [1, 2, 3, 4]
    assert places["lucky"].group is None


def test_fewer_units_cannot_lead_what_has_more():
    places, _ = board(a=units(1.0, 0.02, 1), b=units(0.99, 0.02, 2, count=5))
    assert places["a"].rank == 1


def test_the_leader_is_chosen_on_even_units_and_quoted_on_odd_ones():
    errors = [1.0, 5.0] * 5  # looks best where it is chosen
    _, found = board(a=errors, b=[2.0] * 10)
    assert found.quoted_deg == 5.0


def test_answers_too_few_come_behind_and_without_an_error_last():
    rows = [row("a", 1.0, availability=0.9), row("b", 2.0), row("c", None)]
    found = rank_board(rows, [UnitErrors((1.0,)), UnitErrors((2.0,)), UnitErrors((None,))])
    assert [rows[at]["model"] for at in found.order] == ["b", "a", "c"]
    assert found.places[2].rank is None


def test_false_suns_cost_the_rank():
    honest, false = row("a", 2.0, rms_deg=2.0), row("b", 9.0, rms_deg=1.0)
    assert order(honest, "a") < order(false, "b")


def test_an_error_on_a_bench_is_measured_on_ten_units_or_estimated():
    rows = [row("a", 0.03, unit=unit, condition="on-bench") for unit in range(10)]
    rows += [row("b", 0.03, unit=unit, condition="on-bench") for unit in range(9)]
    found = on_bench(rows)
    assert found == {Cell("d", "nominal", "e", "a"): pytest.approx(0.03)}
    assert expected_on_bench(0.03, 0.04, None) == {
        "on_bench_deg": 0.05,
        "on_bench_basis": "estimated",
    }
    assert expected_on_bench(0.03, 0.04, 0.06)["on_bench_basis"] == "measured"
    assert expected_on_bench(None, 0.04, None)["on_bench_deg"] is None


def test_twins_have_the_same_numbers_under_every_condition_they_share():
    rows = [row(model, 1.0) for model in "abc"]
    rows += [row("a", 2.0, condition="hot"), row("b", 2.5, condition="hot")]
    assert twins_of(rows) == {("e", "c", "d"): "e + a"}
    assert twins_of([row("a", None), row("b", None)]) == {}
