"""Limits, hazards and orders on invented studies and pipelines, small enough to be read."""

import dataclasses
import math
from collections.abc import Callable, Mapping

import pytest
from scores import STUDY, pipeline

from registry.answer import Answer, RankedArchitecture
from registry.calibration import _interval
from registry.comparison import contradictions
from registry.measured_pipelines import Measurements, Score
from registry.recommendation import recommend
from registry.studies import Facts

FactsOf = Callable[[list[Mapping[str, list[str]]]], Facts]


def at(answer: Answer, mask: str = "V-Slit") -> RankedArchitecture | None:
    return next((a for a in answer.architectures if a.place.architecture == ("OI", mask)), None)


# No product of the table of hardware is an OI.
def study(**changed: list[str]) -> dict[str, list[str]]:
    return {**STUDY, "detector": ["OI"], "mask": ["V-Slit"], **changed}


def row(**changed: object) -> object:
    return pipeline(**{"detector": "OI", "mask": "V-Slit", **changed})


def test_reports_and_measurements_are_judged_apart(facts_of: FactsOf) -> None:
    facts = facts_of([study(accuracy_deg=["0.05"])])
    for limit, error, meets in (
        (0.1, 0.04, ("reported", "measured")),
        (0.1, 0.4, ("reported",)),
        (0.045, 0.04, ("measured",)),
        (0.01, 0.04, None),
    ):
        found = at(recommend({"max_error_deg": limit}, [row(rms_deg=error)], facts=facts))
        assert (None if found is None else found.meets) == meets


@pytest.mark.parametrize(
    ("limit", "kept", "beyond"),
    [
        ("max_error_deg", 0.25, 0.2499),
        ("min_fov_deg", 60.0, 60.1),
        ("max_latency_us", 8.0, 7.9),
        ("min_availability", 0.97, 0.971),
    ],
)
def test_a_measured_number_keeps_a_limit_that_it_equals(
    facts_of: FactsOf, limit: str, kept: float, beyond: float
) -> None:
    rows = [row(rms_deg=0.25, half_fov_deg=30.0, latency_us=8.0, availability=0.97)]
    for asked, found in ((kept, True), (beyond, False)):
        assert bool(at(recommend({limit: asked}, rows, facts=facts_of([study()])))) == found  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("numbers", "limit", "kept", "beyond"),
    [
        ({"accuracy_deg": ["0.5"]}, "max_error_deg", 0.5, math.nextafter(0.5, 0)),
        ({"fov_deg": ["120"]}, "min_fov_deg", 120.0, math.nextafter(120.0, 200)),
        ({"accuracy_deg": ["0.3"], "accuracy_kind": ["3sigma"]}, "max_error_deg", 0.1001, 0.0999),
    ],
)
def test_a_reported_number_keeps_a_limit_that_it_equals_as_an_rms(
    facts_of: FactsOf, numbers: dict[str, list[str]], limit: str, kept: float, beyond: float
) -> None:
    facts = facts_of([study(**numbers)])
    assert at(recommend({limit: kept}, facts=facts))
    assert not at(recommend({limit: beyond}, facts=facts))


@pytest.mark.parametrize(
    ("asked", "error", "field"),
    [(None, 0.5, 120.0), (5.0, 0.01, 20.0), (20.0, 0.01, 20.0), (21.0, 0.02, 60.0),
     (61.0, 0.4, 120.0)],
)  # fmt: skip
def test_an_error_is_that_of_the_narrowest_cone_that_holds_the_field(
    facts_of: FactsOf, asked: float | None, error: float, field: float
) -> None:
    cones = ((10.0, 0.01), (30.0, 0.02), (60.0, 0.4))
    rows = [row(rms_deg=0.5, cones=cones)]
    found = at(recommend({"min_fov_deg": asked}, rows, facts=facts_of([study()])))  # type: ignore[arg-type]
    assert found is not None
    assert found.best is not None
    assert found.best.own is not None
    assert (found.best.own.error_deg, found.best.own.field_deg) == (error, field)


BAD = {"albedo": (Score("bad", 0.8, availability=0.9),)}


@pytest.mark.parametrize(
    ("ask", "hazards", "shown"),
    [
        ({"tolerate": "albedo"}, BAD, 0.8),
        ({"tolerate": "albedo"}, {"albedo": (Score("bad", 0.05),)}, 0.1),  # nominal is the worse
        ({"tolerate": "albedo"}, {"albedo": (Score("bad", None),)}, None),
        ({"tolerate": "albedo"}, {"albedo": (Score("bad", 0.2, is_available=False),)}, None),
        ({"tolerate": "albedo"}, {}, None),  # no condition tries it
        ({"tolerate": "albedo", "max_error_deg": 0.5}, BAD, None),
        ({"tolerate": "albedo", "min_availability": 0.9}, BAD, 0.8),
        ({"tolerate": "albedo", "min_availability": 0.91}, BAD, None),
        ({"sun_distance_au": 3.0}, {"noise": (Score("dim", 0.3),)}, 0.3),
        ({"sun_distance_au": 1.2}, {}, 0.1),
    ],
)
def test_a_hazard_is_survived_where_its_condition_was_tried_within_the_limits(
    facts_of: FactsOf, ask: dict[str, object], hazards: object, shown: float | None
) -> None:
    rows = [row(hazards=hazards)]
    found = at(recommend({**ask, "evidence": "measured"}, rows, facts=facts_of([study()])))  # type: ignore[arg-type]
    assert (None if found is None else found.shown_deg) == shown


def test_the_pipeline_that_errs_least_of_those_that_meet_is_shown(facts_of: FactsOf) -> None:
    rows = [
        row(dataset="narrow", rms_deg=0.01, half_fov_deg=10.0, needs=("rates",)),
        row(dataset="wide"),
        row(dataset="seldom", rms_deg=0.001, is_available=False, availability=0.7),
    ]
    for ask, dataset in (
        ({}, "narrow"), ({"min_fov_deg": 90}, "wide"), ({"exclude_needs": "rates"}, "wide"),
    ):  # fmt: skip
        found = at(recommend(ask, rows, facts=facts_of([study()])))  # type: ignore[arg-type]
        assert found is not None
        assert found.best is not None
        assert found.best.pipeline is not None
        assert found.best.pipeline.dataset == dataset


def test_units_within_a_limit_are_counted_and_their_share_decides(facts_of: FactsOf) -> None:
    rows = [row(rms_deg=0.1, unit_own_error_deg=(0.1,) * 10, unit_ratios=(0.9,) * 8 + (1.5,) * 2)]
    for confidence, meets in ((0.8, True), (0.81, False)):
        ask = {"max_error_deg": 0.1, "confidence": confidence}
        answer = recommend(ask, rows, facts=facts_of([study(accuracy_deg=["0.1"])]))  # type: ignore[arg-type]
        found = at(answer)
        assert found is not None
        assert ("measured" in found.meets) == meets
        assert found.best is not None
        assert found.best.units_within == 8


def test_limits_are_judged_in_flight_unless_own_errors_are_asked_for(facts_of: FactsOf) -> None:
    flown = {
        "flight": Score("flight", 0.4, availability=1.0),
        "flight_units_deg": (0.4,) * 10,
        "flight_ratios": (0.5,) * 9 + (2.0,),
    }
    rows = [
        row(rms_deg=0.01, **flown),
        row(rms_deg=0.02, model="lut", stages=("LUT",), flight=Score("flight", 0.1)),
        row(rms_deg=0.001, model="ann", stages=("ANN",)),  # never flown: not judged in flight
    ]
    facts = facts_of([study()])
    for limit, level, best in (
        *((0.2, "flight", "lut"), (0.05, "flight", None)),
        *((0.2, "own", "ann"), (0.05, "own", "ann")),
    ):
        found = at(recommend({"max_error_deg": limit, "level": level}, rows, facts=facts))  # type: ignore[arg-type]
        assert (None if found is None else found.best.pipeline.model) == best  # type: ignore[union-attr]
    default = at(recommend({"model": "SPM"}, rows, facts=facts_of([study(model=["SPM"])])))  # type: ignore[arg-type]
    assert default is not None
    assert default.best is not None
    assert default.best.judged is not None
    assert default.best.own is not None
    assert (default.best.judged.error_deg, default.best.own.error_deg) == (0.4, 0.01)
    # each level has the interval of its own units
    low, high = default.best.flight_interval_deg or (0.0, 0.0)
    assert math.isclose(high / 0.4, 0.4 / low)
    assert math.isclose(math.log(high / 0.4), 2.0 * math.log(4.0) * math.sqrt(0.1) / math.sqrt(10))


def test_a_record_without_flights_is_judged_by_own_errors(facts_of: FactsOf) -> None:
    found = at(recommend({"max_error_deg": 0.2}, [row(rms_deg=0.1)], facts=facts_of([study()])))  # type: ignore[list-item]
    assert found is not None
    assert found.best is not None
    assert found.best.flight is None
    answer = recommend({"max_error_deg": 0.2}, [row(rms_deg=0.1)], facts=facts_of([study()]))  # type: ignore[list-item]
    assert answer.level == "own", "what is judged, not what is asked for"


def test_failed_runs_and_numbers_that_are_none_do_not_count() -> None:
    rows = [row(dataset="c"), row(dataset="a", model="z"), row(rms_deg=None), row(rms_deg=math.nan)]
    for order in (rows, rows[::-1]):
        found = Measurements(order).by_architecture["OI", "V-Slit"]  # type: ignore[arg-type]
        assert [one.dataset for one in found] == ["a", "c"]
    assert Score("nominal", 1.0, bound_deg=math.inf).bound_deg is None


def test_what_nobody_built_comes_last_however_small_its_error(facts_of: FactsOf) -> None:
    rows = [row(rms_deg=0.5), row(dataset="e", mask="L-Slit", rms_deg=0.001)]
    for sort in ("evidence", "error"):
        answer = recommend({"detector": "OI", "min_fov_deg": 90.0}, rows,  # type: ignore[arg-type]
                           sort=sort, facts=facts_of([study()]))  # fmt: skip
        assert [(one.place.architecture[1], one.rank) for one in answer.architectures] == [
            ("V-Slit", 1),
            ("L-Slit", 2),
        ]


def test_measurements_contradict_on_one_data_set_and_condition_alone(facts_of: FactsOf) -> None:
    facts = facts_of([study(), study()])
    used = row(rms_deg=0.1)
    lut = {"model": "lut", "stages": ("LUT",)}
    hot = {"albedo": (Score("bad", 0.5),)}
    ask: dict[str, object] = {"detector": "OI", "mask": "V-Slit"}
    for others, asked, said in (
        ([row(rms_deg=0.02, **lut)], ask, 5.0),
        ([row(rms_deg=0.02, dataset="e", **lut)], ask, None),
        ([row(rms_deg=0.092, **lut)], ask, None),  # hardly differs
        ([row(rms_deg=0.02, hazards=hot, **lut)], {**ask, "tolerate": "albedo"}, None),
    ):
        found = contradictions(recommend(asked, [used, *others], facts=facts))  # type: ignore[list-item]
        assert [one.ratio for one in found] == ([] if said is None else [pytest.approx(said)])
        for one in found:
            assert one.studies == 2
            assert "2 studies used bctm + spm, own error 0.1 deg; bctm + lut" in one.sentence
            assert "on the same data (d, nominal), 5 times smaller" in one.sentence
    exact = contradictions(recommend(ask, [used, row(rms_deg=0.0, **lut)], facts=facts))  # type: ignore[list-item]
    assert [one.ratio for one in exact] == [None]
    assert "times" not in exact[0].sentence


def test_compensations_are_stages_that_a_study_stands_for_without_a_model(
    facts_of: FactsOf,
) -> None:
    facts = facts_of([study(model=["OCM"]), study(), study(model=["OCM", "LUT"])])
    rows = [row(model="glass>spm", stages=("OCM", "SPM"))]
    found = at(recommend({"detector": "OI"}, rows, facts=facts))  # type: ignore[arg-type]
    assert found is not None
    users = {one.stages: one.users for one in found.place.designs}
    assert users == {
        ("OCM", "SPM"): {"S0"},
        ("SPM",): {"S1"},
        ("OCM",): {"S0", "S2"},
        ("LUT",): {"S2"},
    }


def test_an_interval_is_of_an_error_and_of_measured_units() -> None:
    one = row(rms_deg=0.3, unit_own_error_deg=(0.3,) * 4)
    judged = one.judge((), None)  # type: ignore[attr-defined]
    low, high = _interval(one, judged) or (0.0, 0.0)  # type: ignore[arg-type]
    assert low <= judged.error_deg <= high
    assert _interval(None, judged) is None
    assert _interval(one, dataclasses.replace(judged, error_deg=math.inf)) is None  # type: ignore[arg-type]
