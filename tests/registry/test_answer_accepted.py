"""What the answer must say, on the survey and the published measurements."""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from api.schema.requirements import Requirements as Asked
from api.service.reasons import reason
from api.service.recommendations import document
from registry.answer import Answer, RankedArchitecture
from registry.comparison import contradictions
from registry.measured_pipelines import Measurements
from registry.recommendation import recommend
from registry.studies import Facts
from survey_data.processors import factor
from tests.registry.brute_force import BruteForce, expanded
from tests.registry.drawn_questions import drawn_questions


def places(answer: Answer) -> list[tuple[str, str]]:
    return [one.place.architecture for one in answer.architectures]


def notes(answer: Answer) -> str:
    return " ".join(document(answer, Asked(), (), None).notes)


def measured(answer: Answer) -> list[RankedArchitecture]:
    return [one for one in answer.architectures if "measured" in one.meets]


@pytest.mark.parametrize("of", ["UFSS", "VFSS"])
def test_a_fine_class_is_led_by_what_reports_it_with_the_bench_each_needs(
    of: str, published: Measurements
) -> None:
    answer = recommend({"accuracy": of}, published)
    reporting = ["reported" in one.meets for one in answer.architectures]
    assert reporting[0]
    assert reporting == sorted(reporting, reverse=True)
    assert any(of in report.classes for report in answer.architectures[0].reports)
    assert all(one.best and one.best.needs_bench_deg for one in measured(answer))


def test_the_fine_wide_camera_is_that_of_two_studies(published: Measurements) -> None:
    ask = {"detector": "CMOS", "max_error_deg": 0.01, "min_fov_deg": 120}
    (found,) = (
        one
        for one in recommend(ask, published).architectures[:3]
        if one.place.architecture == ("CMOS", "Encoded")
    )
    stated = {report.key: report.accuracy for report in found.reports}
    assert {"Zhang2021", "Zhang2022a"} <= stated.keys()
    assert min(one.value_deg for one in stated.values() if one) == 0.0023


def test_coarse_sensors_are_photodiodes_quadrants_and_cells(published: Measurements) -> None:
    found = places(recommend({"accuracy": "CSS"}, published))
    assert {detector for detector, _ in found[:4]} == {"PD", "PSD", "QPD", "PVA"}
    assert not any(detector == "CCD" for detector, _ in found)


def test_the_full_sphere_is_led_by_what_was_built_for_it(published: Measurements) -> None:
    ask = {"min_fov_deg": 360, "max_error_deg": 1.0}
    first = recommend({**ask, "level": "own"}, published).architectures[0]
    assert first.place.architecture == ("PVA", "Maskless")
    assert first.place.is_built
    # in flight the Earth is in view: only filters on the data sets in orbit allow for it
    flown = recommend(ask, published).architectures
    assert {one.place.architecture for one in flown} == {("PVA", "Maskless"), ("PD", "Maskless")}
    assert all(one.best.pipeline.dataset in {"pva-orbit", "pd-orbit"} for one in flown)


def test_a_flight_is_no_better_than_the_sensor_on_the_ground(published: Measurements) -> None:
    rows = [row for row in published.rows if row.flight and len(row.flight_units_deg) == 10]
    assert len(rows) > 150
    ratios = [row.flight.rms_deg / row.nominal.rms_deg for row in rows if row.flight.rms_deg]
    assert min(ratios) > 0.99
    assert np.median(ratios) > 3.0


def test_power_is_of_three_products_or_unknown_and_self_powered_is_said(
    published: Measurements,
) -> None:
    said = {}
    for one in recommend({"task": "Power"}, published).architectures:
        (measure,) = one.measures
        drawing = [p.power_mw for p in one.place.products if p.power_mw is not None]
        assert (measure.value is None) == (len(drawing) < 3)
        said[one.place.architecture] = measure.words
        own = [p.family for p in one.place.products if p.supply == "self-powered"]
        assert all(family in measure.words for family in own)
    assert "self-powered" in said["CMOS", "Encoded"]


def test_a_latency_is_judged_by_published_times_and_the_readers_processor(
    published: Measurements,
) -> None:
    asked = {"max_error_deg": 0.5, "max_latency_us": 100.0, "level": "own"}
    here = recommend(asked, published)
    assert len(measured(here)) > 1
    assert all(
        one.best.latency_us <= 100.0
        for one in measured(here)
        if one.best is not None and one.best.latency_us is not None
    )
    slow = recommend({**asked, "processor": "gr712rc"}, published)
    assert 0 < len(measured(slow)) < len(measured(here))
    same = recommend({**asked, "processor": str(factor("gr712rc"))}, published)
    assert places(same) == places(slow)


def test_a_bench_that_stands_in_the_way_is_said_and_the_one_named_would_do(
    published: Measurements,
) -> None:
    ask = {"max_error_deg": 0.02, "bench_deg": 0.05}
    answer = recommend(ask, published)
    named = re.search(
        r"bench of 0.05 deg stands in the way of (\d+) .* needs one of (\S+) deg", notes(answer)
    )
    assert named is not None
    better = measured(recommend({**ask, "bench_deg": float(named[2])}, published))
    assert len(measured(answer)) < len(better) <= len(measured(answer)) + int(named[1])


def test_nothing_asked_has_no_ranks_and_three_cards(published: Measurements) -> None:
    answer = recommend({}, published)
    assert {one.rank for one in answer.architectures} == {None}
    cards = document(answer, Asked(), (), None).cards
    assert [card.title for card in cards] == [
        "most built", "advised for accuracy", "lowest simulated",
    ]  # fmt: skip
    assert (cards[0].detector, cards[0].mask) == ("CMOS", "Single-Ap.")
    assert all(("built by nobody" in card.words) == (not card.built) for card in cards[1:])


def test_a_study_is_found_by_its_model_though_nobody_flew_it(published: Measurements) -> None:
    flown = {row.stages for row in published.at("flight").by_architecture["PD", "Slit"]}
    assert ("OCM", "SPM") not in flown
    for evidence in ("any", "reported"):
        answer = recommend({"model": "SPM", "evidence": evidence}, published)
        (one,) = (a for a in answer.architectures if a.place.architecture == ("PD", "Slit"))
        assert "Hales2002" in {report.key for report in one.reports}


@pytest.mark.slow
@pytest.mark.parametrize("number", [40, pytest.param(200, marks=pytest.mark.slow)])
def test_drawn_answers_hide_no_report_and_compare_no_two_data_sets(
    number: int, survey: Facts, published: Measurements
) -> None:
    brute = BruteForce(survey, published)
    names = {row.dataset for row in published.rows}
    own = {(r.dataset, f"{r.extractor} + {r.model}"): r for r in published.rows}
    for drawn in drawn_questions(number, 2, survey):
        ask = {**drawn, "evidence": "any"}
        answer, given = recommend(ask, published), expanded(ask)
        found = answer.architectures
        for pair in (one for one in brute.pairs if brute.in_scope(given, one)):
            if any(brute.report_meets(given, pair, one) for one in brute.reports[pair]):
                assert pair in places(answer), ask
        if found and not found[0].place.is_built:
            assert not any(one.place.is_built for one in found), ask
        for one in contradictions(answer):
            assert named(one.sentence, names) == {one.dataset}
            for name, error in (
                (one.first, one.first_own_error_deg),
                (one.other, one.other_own_error_deg),
            ):
                half = given["min_fov_deg"] / 2 if "min_fov_deg" in given else None
                judged = own[one.dataset, name].judge(given["hazards"], half)
                assert (judged.error_deg, judged.condition) == (error, one.condition)
        for architecture in found:
            assert len(named(reason(answer, architecture), names)) <= 1, ask


def named(sentence: str, names: set[str]) -> set[str]:
    return names & set(re.findall(r"[\w.-]*\w", sentence))


def limits(number: int, seed: int) -> Iterator[dict[str, Any]]:
    rng = np.random.default_rng(seed)
    for _ in range(number):
        ask: dict[str, Any] = {"max_error_deg": float(f"{10 ** rng.uniform(-2.8, 0):.3g}")}
        if rng.random() < 0.4:
            ask["min_fov_deg"] = float(rng.uniform(20, 140))
        if rng.random() < 0.4:
            ask["confidence"] = float(rng.uniform(0.5, 0.99))
        if rng.random() < 0.2:
            ask["tolerate"] = ["albedo"]
        yield ask


@pytest.mark.parametrize("number", [40, pytest.param(200, marks=pytest.mark.slow)])
def test_the_bench_that_a_row_says_it_needs_does_and_one_a_tenth_worse_does_not(
    number: int,
    published: Measurements,
) -> None:
    """Two digits are named, rounded down; a bench worse than the limit itself is never named."""
    compared = 0
    for at, ask in enumerate(limits(number, 8)):
        rows = [one for one in measured(recommend(ask, published)) if one.best]
        if not rows:
            continue
        one = rows[at % len(rows)]
        best = one.best
        assert best is not None
        assert best.needs_bench_deg is not None
        assert best.pipeline is not None
        if not best.needs_bench_deg:
            continue
        kept = {}
        for times in (1.0, 1.1):
            bench = times * best.needs_bench_deg
            question = recommend({**ask, "bench_deg": bench}, published).question
            kept[times] = bool(question.measured[question.table.rows.index(best.pipeline)])
        compared += 1
        assert kept[1.0], (ask, best.needs_bench_deg)
        assert not kept[1.1] or 1.1 * best.needs_bench_deg > ask["max_error_deg"], ask
    assert compared > number / 2


def test_an_order_that_follows_the_heights_is_told_as_theirs(published: Measurements) -> None:
    answer = recommend({"max_error_deg": 1.0}, published)
    found = answer.height_order
    assert found is not None
    best = [(one.shown_deg, one.best and one.best.pipeline) for one in answer.architectures]
    known = [(e, made.height_mm) for e, made in best if made and made.height_mm]
    assert found.sensors == sum(np.isfinite(error) for error, _ in known)
    assert found.sensors + found.without == len(best)
    assert (found.sentence in notes(answer)) == found.holds
    assert document(answer, Asked(), (), None).height_order is not None
    assert recommend({}, published).height_order is None
