"""Recommendations where something was measured: limits, hazards, orders and sentences."""

import math
from collections.abc import Callable, Mapping

import pytest
from scores import STUDY, pipeline

from registry.measured_pipelines import Measurements, Score
from registry.recommendation import Architecture, Recommendation, recommend
from registry.studies import Facts

Rows = list[Mapping[str, list[str]]]


def one_study(facts_of: Callable[[Rows], Facts], **numbers: str) -> Facts:
    return facts_of([{**STUDY, **{a: [n] for a, n in numbers.items()}}])


def by_mask(facts_of: Callable[[Rows], Facts], *masks: str) -> Facts:
    """A study a mask, all else alike."""
    return facts_of([{**STUDY, "mask": [mask]} for mask in masks])


def only(answer: Recommendation) -> Architecture:
    (architecture,) = answer.architectures
    return architecture


def error_of(place: Architecture) -> object:
    return place.best.measured and place.best.measured["error_deg"]


def masks_of(answer: Recommendation) -> list[str]:
    return [a.mask for a in answer.architectures]


def test_a_measurement_outranks_what_the_study_states(facts_of: Callable[[Rows], Facts]) -> None:
    facts = one_study(facts_of, accuracy_deg="0.01")
    ask = {"max_error_deg": 0.05}
    assert only(recommend(ask, facts=facts)).best.basis == {"max_error_deg": "stated"}
    assert recommend(ask, [pipeline()], facts=facts).count == 0
    found = only(recommend(ask, [pipeline(rms_deg=0.04)], facts=facts))
    assert found.best.basis == {"max_error_deg": "measured"}
    assert error_of(found) == 0.04


def test_min_fov_is_the_full_field_of_view(facts_of: Callable[[Rows], Facts]) -> None:
    facts = one_study(facts_of)
    assert recommend({"min_fov_deg": 120}, [pipeline()], facts=facts).count == 1
    assert recommend({"min_fov_deg": 120.1}, [pipeline()], facts=facts).count == 0


def test_an_error_is_that_of_the_narrowest_cone_that_holds_the_field(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = one_study(facts_of)
    row = pipeline(rms_deg=0.5, cones=((10.0, 0.01), (30.0, 0.02), (60.0, 0.4)))
    for asked, error, field in (
        (None, 0.5, 120.0),
        (5.0, 0.01, 20.0),
        (20.0, 0.01, 20.0),
        (21.0, 0.02, 60.0),
        (61.0, 0.4, 120.0),
    ):
        best = only(recommend({"min_fov_deg": asked}, [row], facts=facts)).best.measured
        assert best is not None
        assert (best["error_deg"], best["field_deg"]) == (error, field)
    ask = {"min_fov_deg": 60.0, "max_error_deg": 0.02}
    assert recommend(ask, [row], facts=facts).count == 1
    assert recommend({**ask, "min_fov_deg": 70.0}, [row], facts=facts).count == 0


def test_a_cone_without_an_error_gives_way_to_a_wider_one(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = one_study(facts_of)
    row = pipeline(rms_deg=0.5, cones=((10.0, None), (30.0, 0.02), (60.0, None)))
    found = only(recommend({"min_fov_deg": 10.0}, [row], facts=facts)).best.measured
    assert found is not None
    assert (found["error_deg"], found["field_deg"]) == (0.02, 60.0)
    wide = only(recommend({"min_fov_deg": 90.0}, [row], facts=facts)).best.measured
    assert wide is not None
    assert (wide["error_deg"], wide["field_deg"]) == (0.5, 120.0)


def worse(rms_deg: float | None, **more: object) -> tuple[Score, ...]:
    return (Score("bad", rms_deg, **more),)  # type: ignore[arg-type]


def test_a_pipeline_is_judged_by_its_worst_condition_of_those_asked_for(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = one_study(facts_of)
    row = pipeline(hazards={"albedo": worse(0.9), "spin": worse(0.05)})
    for survive, error, condition in (
        ([], 0.1, "nominal"),
        (["spin"], 0.1, "nominal"),
        (["albedo"], 0.9, "bad"),
        (["spin", "albedo"], 0.9, "bad"),
    ):
        best = only(recommend({"survive": survive}, [row], facts=facts)).best.measured
        assert best is not None
        assert (best["error_deg"], best["condition"], best["nominal_deg"]) == (
            error, condition, 0.1,
        )  # fmt: skip
    ask = {"survive": "albedo", "max_error_deg": 0.5}
    answer = recommend(ask, [row], facts=facts)
    assert answer.blocking_constraint is not None
    assert answer.blocking_constraint.constraints == ("max_error_deg",)
    assert {tuple(r.drop) for r in answer.blocking_constraint.relaxations if r.drop} == {
        ("max_error_deg",), ("survive",),
    }  # fmt: skip


def test_what_no_condition_tries_does_not_survive_it_and_the_answer_says_so(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = by_mask(facts_of, "Slit", "Lens")
    rows = [pipeline(hazards={"albedo": worse(0.2)}), pipeline(dataset="e", mask="Lens")]
    answer = recommend({"survive": "albedo"}, rows, facts=facts)
    assert masks_of(answer) == ["Slit"]
    assert answer.document["untried"] == {"albedo": [{"detector": "CMOS", "mask": "Lens"}]}


@pytest.mark.parametrize("broken", [worse(None), worse(0.2, is_available=False)])
def test_a_refused_or_seldom_answered_condition_is_not_survived(
    facts_of: Callable[[Rows], Facts], broken: tuple[Score, ...]
) -> None:
    row = pipeline(hazards={"spin": broken})
    facts = one_study(facts_of)
    assert recommend({"survive": "spin"}, [row], facts=facts).count == 0
    assert recommend({}, [row], facts=facts).count == 1


def test_availability_is_the_least_over_the_conditions_asked_for(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = one_study(facts_of)
    row = pipeline(availability=0.99, hazards={"spin": worse(0.2, availability=0.96)})
    for ask, met in (
        ({"min_availability": 0.99}, 1),
        ({"min_availability": 0.995}, 0),
        ({"min_availability": 0.96, "survive": "spin"}, 1),
        ({"min_availability": 0.97, "survive": "spin"}, 0),
    ):
        assert recommend(ask, [row], facts=facts).count == met


def test_the_pipeline_that_errs_least_of_those_that_keep_the_limits_is_shown(
    facts_of: Callable[[Rows], Facts],
) -> None:
    rows = [
        pipeline(dataset="narrow", rms_deg=0.01, half_fov_deg=10.0),
        pipeline(dataset="wide"),
    ]
    facts = one_study(facts_of)
    for ask, shown, other in (({}, "narrow", "wide"), ({"min_fov_deg": 90}, "wide", "narrow")):
        best = only(recommend(ask, rows, facts=facts)).best
        assert best.measured is not None
        assert best.measured["dataset"] == shown
        assert [one["dataset"] for one in best.other_datasets] == [other]


def test_failed_runs_and_numbers_that_are_none_do_not_count(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = one_study(facts_of)
    failed = [pipeline(rms_deg=None), pipeline(model="b", rms_deg=math.nan)]
    assert only(recommend({}, failed, facts=facts)).best.measured is None
    assert Score("nominal", 1.0, over_bound=math.inf).over_bound is None


def test_what_seldom_answers_keeps_no_limit_of_error_and_is_last_by_what_is_measured(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = by_mask(facts_of, "Slit", "Lens")
    silent = pipeline(rms_deg=0.001, is_available=False, availability=0.7)
    rows = [silent, pipeline(dataset="e", mask="Lens", rms_deg=5.0)]
    assert masks_of(recommend({}, rows, sort="measured", facts=facts)) == ["Lens", "Slit"]
    assert masks_of(recommend({"max_error_deg": 6.0}, rows, facts=facts)) == ["Lens"]
    assert only(recommend({"mask": "Slit"}, rows, facts=facts)).best.measured is not None
    answering = pipeline(dataset="f", rms_deg=0.4)
    best = only(recommend({}, [silent, answering], facts=one_study(facts_of))).best
    assert best.measured is not None
    assert best.measured["dataset"] == "f"


def test_a_coarse_best_names_what_is_far_finer_where_it_answers(
    facts_of: Callable[[Rows], Facts],
) -> None:
    """A grid that is read surely on most of its field: neither hidden, nor first."""
    facts = one_study(facts_of)
    coarse = pipeline(rms_deg=3.0)
    for rms_deg, share, of_it in (
        (0.01, 0.7, True),
        (0.01, 0.5, True),
        (0.01, 0.49, False),  # answers less than half
        (1.0, 0.7, False),  # three times as fine is not more than three times
        (0.999, 0.7, True),
    ):
        seldom = pipeline(
            extractor="grid", model="lut", stages=("LUT",), rms_deg=rms_deg,
            is_available=False, availability=share,
        )  # fmt: skip
        best = only(recommend({}, [coarse, seldom], facts=facts)).best.measured
        assert best is not None
        assert best["error_deg"] == 3.0
        named = {"dataset": "d", "extractor": "grid", "model": "lut",
                 "error_deg": rms_deg, "availability": share}  # fmt: skip
        assert best["finer"] == (named if of_it else None)


@pytest.mark.parametrize(
    "ask",
    [
        {"exclude_model": ["LUT"]},
        {"exclude_extractor": ["MCAM"]},
        {"min_availability": 0.8},
        {"max_latency_us": 5.0},
        {"survive": ["spin"]},
        {"min_fov_deg": 100.0},
    ],
)
def test_what_is_finer_keeps_all_else_that_is_asked(
    facts_of: Callable[[Rows], Facts], ask: dict[str, object]
) -> None:
    seldom = pipeline(
        extractor="grid", extractor_taxonomy="MCAM", model="lut", stages=("LUT",), rms_deg=0.01,
        is_available=False, availability=0.7, latency_us=9.0, half_fov_deg=45.0,
    )  # fmt: skip
    coarse = pipeline(rms_deg=3.0, latency_us=1.0, hazards={"spin": worse(3.0, availability=1.0)})
    facts = one_study(facts_of)
    for asked, named in (({}, "grid"), (ask, None)):
        best = only(recommend(asked, [coarse, seldom], facts=facts)).best.measured
        assert best is not None
        assert (best["finer"] or {}).get("extractor") == named  # type: ignore[attr-defined]


def test_compensations_are_stages_that_a_study_stands_for_without_a_model(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = facts_of([{**STUDY, "model": ["OCM"]}, STUDY, {**STUDY, "model": ["OCM", "LUT"]}])
    place = only(recommend({}, [pipeline(model="glass>spm", stages=("OCM", "SPM"))], facts=facts))
    of = {(c.compensations, c.model): c.studies for c in place.calibrations}
    assert of == {(("OCM",), "SPM"): ("S0",), ((), "SPM"): ("S1",), ((), "OCM"): ("S0", "S2"),
                  ((), "LUT"): ("S2",)}  # fmt: skip


@pytest.mark.parametrize(
    ("asked", "unbeaten"),
    [({}, ["Slit"]), ({"survive": "albedo"}, ["Encoded"]), ({"min_fov_deg": 90.0}, ["Encoded"])],
)
def test_the_pareto_set_is_of_the_error_asked_for(
    facts_of: Callable[[Rows], Facts], asked: dict[str, object], unbeaten: list[str]
) -> None:
    rows = [
        pipeline(half_fov_deg=30.0, hazards={"albedo": worse(3.0)}),
        pipeline(dataset="e", mask="Encoded", rms_deg=0.2, hazards={"albedo": worse(0.3)}),
        pipeline(dataset="f", mask="Lens", rms_deg=0.3, hazards={"albedo": worse(0.4)}),
    ]
    facts = by_mask(facts_of, "Lens", "Encoded", "Slit")
    answer = recommend(asked, rows, facts=facts)
    assert [a.mask for a in answer.architectures if a.pareto] == unbeaten
    backed = recommend(asked, rows, facts=by_mask(facts_of, "Lens", "Encoded", "Slit", "Lens"))
    assert {a.mask for a in backed.architectures if a.pareto} == {*unbeaten, "Lens"}


@pytest.mark.parametrize(
    ("numbers", "limit", "at", "beyond"),
    [
        ({"accuracy_deg": "0.5"}, "max_error_deg", 0.5, math.nextafter(0.5, 0)),
        ({"fov_deg": "120"}, "min_fov_deg", 120.0, math.nextafter(120.0, 200)),
    ],
)
def test_a_stated_number_keeps_a_limit_that_it_equals(
    facts_of: Callable[[Rows], Facts],
    numbers: dict[str, str],
    limit: str,
    at: float,
    beyond: float,
) -> None:
    facts = one_study(facts_of, **numbers)
    assert recommend({limit: at}, facts=facts).count == 1
    assert recommend({limit: beyond}, facts=facts).count == 0


def test_a_measured_number_keeps_a_limit_that_it_equals(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = one_study(facts_of)
    row = pipeline(rms_deg=0.25, half_fov_deg=30.0, latency_us=8.0, availability=0.97)
    for limit, at, beyond in (
        ("max_error_deg", 0.25, 0.2499),
        ("min_fov_deg", 60.0, 60.1),
        ("max_latency_us", 8.0, 7.9),
        ("min_availability", 0.97, 0.971),
    ):
        assert only(recommend({limit: at}, [row], facts=facts)).best.basis == {limit: "measured"}
        assert recommend({limit: beyond}, [row], facts=facts).count == 0


def test_a_score_says_its_bound_its_answers_and_its_spread_over_units() -> None:
    row = pipeline(bound_deg=0.05, over_bound=2.0, latency_us=3.0, unit_own_deg=(0.1, 0.3, 0.05))
    (place,) = recommend({}, [row], sort="measured", limit=1).architectures
    assert place.best.measured is not None
    assert place.best.measured["units"] == {
        "count": 3, "least_deg": 0.05, "largest_deg": 0.3, "within_limit": None, "of": 10,
    }  # fmt: skip
    assert place.best.measured["latency_us"] == 3.0
    assert place.best.measured["fov_deg"] == 120.0
    nominal = place.best.measured["nominal"]
    assert isinstance(nominal, dict)
    assert (nominal["bound_deg"], nominal["over_bound"]) == (0.05, 2.0)


def test_pipelines_of_an_architecture_are_in_the_order_of_their_names() -> None:
    rows = [
        pipeline(dataset="c"),
        pipeline(dataset="a", extractor="z"),
        pipeline(dataset="a", rms_deg=None),
        pipeline(dataset="e", mask="Lens"),
    ]
    for order in (rows, rows[::-1]):
        found = Measurements(order).by_architecture["CMOS", "Slit"]
        assert [(row.dataset, row.extractor) for row in found] == [("a", "z"), ("c", "bctm")]


def test_support_is_said_to_four_decimals(facts_of: Callable[[Rows], Facts]) -> None:
    facts = facts_of([STUDY, {**STUDY, "extractor": ["BCM"]}, {**STUDY, "model": ["LUT"]}])
    first = only(recommend({}, facts=facts)).calibrations[0]
    assert first.support == 1.8171  # of 3 studies, 2 and 1
    assert first.with_model == 2
