"""Answers to drawn questions, on the survey and the published measurements, by brute force."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise, product
from statistics import median, stdev
from typing import Any

import numpy as np
import pytest

from registry.answer import Answer, RankedArchitecture
from registry.measured_pipelines import MeasuredPipeline, Measurements
from registry.ranking import SORTS
from registry.recommendation import recommend
from registry.requirements import LEVELS
from registry.studies import Facts
from tests.registry.brute_force import OF_PRODUCTS, BruteForce, Report, expanded, of_product
from tests.registry.drawn_questions import drawn_questions

STATES = {True: "meets", False: "misses", None: "unknown"}
STATED = ("max_error_deg", "min_fov_deg", "accuracy", "exclude_accuracy", *OF_PRODUCTS)
SILENT = ("min_availability", "max_latency_us", "tolerate", "exclude_needs")
Levels = Mapping[str, BruteForce]
Evidence = tuple[Sequence[Report], Sequence[tuple[float, MeasuredPipeline]]]


@pytest.fixture(scope="module")
def timed(published: Measurements) -> Measurements:
    """What is published, seven in ten pipelines with a drawn time."""
    rng = np.random.default_rng(3)
    times = [float(t) if rng.random() < 0.7 else None for t in rng.uniform(1, 300, 10_000)]
    pairs = zip(published.rows, times, strict=False)
    return Measurements(replace(row, latency_us=time) for row, time in pairs)


@pytest.fixture(scope="module")
def brute_force(survey: Facts, timed: Measurements) -> Levels:
    return by_level(survey, timed)


def by_level(facts: Facts, measured: Measurements) -> Levels:
    """Return brute force on what was measured in flight, and on own errors."""
    return {level: BruteForce(facts, measured.at(level)) for level in LEVELS}


@pytest.mark.parametrize(
    ("number", "seed"), [(20, 11), pytest.param(500, 50, marks=pytest.mark.slow)]
)
def test_architectures_evidence_and_order_are_those_of_brute_force(
    number: int, seed: int, timed: Measurements, brute_force: Levels
) -> None:
    answered = _compare(number, seed, timed, brute_force)
    assert answered > number // 2


def test_where_nothing_is_measured_reports_answer(survey: Facts) -> None:
    nothing = Measurements()
    assert _compare(40, 12, nothing, by_level(survey, nothing)) > 10


def test_tasks_and_errors_are_of_one_study_or_each_of_them_advised(
    survey: Facts, timed: Measurements, brute_force: Levels
) -> None:
    brute = brute_force["flight"]
    values = [survey.taxonomy.values(name) for name in ("task", "error")]
    for task, error in product(*values):
        question = recommend({"task": task, "error": error}, timed).question
        places = zip(question.table.places, question.places, strict=True)
        found = {place.architecture for place, is_in in places if is_in}
        ask = {"task": [task], "error": [error]}
        assert found == {pair for pair in brute.pairs if brute.in_scope(ask, pair)}


def _compare(number: int, seed: int, measured: Measurements, brute_force: Levels) -> int:
    """Check drawn questions, and return to how many there is an answer."""
    answered = 0
    for at, ask in enumerate(drawn_questions(number, seed, brute_force["own"].facts)):
        sort, level = SORTS[max(0, at % 5 - 2)], LEVELS[at % 2]
        brute = brute_force[level]
        answer = recommend({**ask, "level": level}, measured, sort=sort)
        expected = brute.answer(ask)
        found = {one.place.architecture: one for one in answer.architectures}
        assert set(found) == set(expected), ask
        assert (answer.explanation is None) == bool(found), ask
        for pair, one in found.items():
            assert len(list(answer.calibrations(one))) == one.calibrations
            _agrees(one, expected[pair], expanded(ask), brute)
        _is_in_order(answer, expected)
        answered += bool(found)
    return answered


def _agrees(
    one: RankedArchitecture, expected: Evidence, ask: Mapping[str, Any], brute: BruteForce
) -> None:
    reports, pipelines = expected
    pair = one.place.architecture
    assert one.meets == ("reported",) * bool(reports) + ("measured",) * bool(pipelines), ask
    if reports:
        assert {report.key for report in one.reports} == {report.key for report in reports}, ask
    measured = {(row.extractor_taxonomy, row.stages) for row in brute.rows[pair]}
    meeting = {(row.extractor_taxonomy, row.stages) for _, row in pipelines}
    keys = {report.key for report in reports if report.study is not None}
    designs = brute.designs_with(ask, pair).items()
    used = {design for design, users in designs if design not in measured and users & keys}
    assert one.calibrations == len(meeting | used), ask
    for at, kind in enumerate(("reported", "measured")):
        for name, states in one.evidence.items():
            if kind in one.meets and not (at == 0 and name in OF_PRODUCTS):
                assert states[at] in {"meets", None}, (ask, name)
    first = {report.key: report for report in brute.reports[pair]}
    for report in one.reports[:1]:
        for name in {*STATED, *SILENT} & ask.keys():
            state = STATES[brute.report_state(ask, pair, first[report.key], name)]
            assert one.evidence[name][0] == state, (ask, name)


def _is_in_order(answer: Answer, expected: Mapping[tuple[str, str], Evidence]) -> None:
    """Check places of groups, and in each the values that order it and the ranks they share."""
    asked, ordered = answer.question.requirements, answer.architectures
    if not asked.names:
        backing = [one.backing for one in ordered]
        assert backing == sorted(backing, reverse=True)
        assert {one.rank for one in ordered} == {None}
        return
    tier = {("reported", "measured"): 0, ("reported",): 1, ("measured",): 2}
    groups = [
        (not one.place.is_built, tier[one.meets] if answer.sort == "evidence" else 0)
        for one in ordered
    ]
    assert groups == sorted(groups), asked
    values = [_value(answer, one, *expected[one.place.architecture]) for one in ordered]
    ranks = [one.rank for one in ordered]
    assert ranks == [ranks.index(rank) + 1 for rank in ranks]
    assert [one.tied for one in ordered] == [ranks.count(rank) > 1 for rank in ranks]
    heads = []
    for rank in sorted({rank for rank in ranks if rank is not None}):
        here = [at for at, other in enumerate(ranks) if other == rank]
        assert len({groups[at] for at in here}) == 1
        backing = [ordered[at].backing for at in here]
        assert backing == sorted(backing, reverse=True), asked
        of_group = [values[at] for at in here]
        if None in of_group:
            continue
        head = min(of_group)  # type: ignore[type-var]  # numbers
        heads.append((groups[here[0]], head))
        first = here[of_group.index(head)]
        for at in here:
            assert _alike(answer, head, values[at], [expected[ordered[n].place.architecture]
                                                     for n in (first, at)]), asked  # fmt: skip
    assert heads == sorted(heads), asked
    for (group, head), (other, after) in pairwise(heads):
        if group == other and _by_error(answer):
            assert after > 1.1 * head, asked


def _by_error(answer: Answer) -> bool:
    asked = answer.question.requirements
    of_class = "accuracy" in asked.include and asked.max_error_deg is None
    return answer.sort == "error" or (
        answer.sort == "evidence"
        and not of_class
        and asked.include.get("task", ()) in {(), ("Accuracy",)}
    )


def _value(
    answer: Answer, one: RankedArchitecture, reports: Sequence[Report], pipelines: Any
) -> float | None:
    """Return what orders an architecture in its group; None where no rule here tells."""
    asked = answer.question.requirements
    tasks = asked.include.get("task", ())
    if answer.sort == "studies":
        return -float(one.backing)
    stated = [rms for one in reports if (rms := one.numbers["max_error_deg"]) is not None]
    shown = min([error for error, _ in pipelines] or stated, default=math.inf)
    assert one.shown_deg == pytest.approx(shown, rel=1e-9)
    if _by_error(answer):
        return one.shown_deg
    if "accuracy" in asked.include and asked.max_error_deg is None:
        return -float(len({report.family for report in reports}))
    if tasks in {("Power",), ("Volume",), ("Cost",)}:
        names = {"Power": "max_power_mw", "Volume": "max_mass_g"}
        known = [] if tasks == ("Cost",) else [
            number
            for built in one.place.products
            if not (tasks == ("Power",) and built.supply == "self-powered")
            and (number := of_product(built, names[tasks[0]])) is not None
        ]  # fmt: skip
        if len(known) >= 3:
            return median(known)
        with_task = sum(tasks[0] in study.of("task") for study in one.place.studies.values())
        return 1e9 - with_task
    return None


def _alike(answer: Answer, head: float, value: float | None, of: Sequence[Evidence]) -> bool:
    if not _by_error(answer) or value is None or math.isinf(head):
        return value == head
    spread = 0.0
    if answer.question.requirements.bench_deg is None:
        spread = math.hypot(*(_standard_error(pipelines) for _, pipelines in of))
    return value <= head * max(1.1, math.exp(2.0 * spread)) * (1 + 1e-9)


def _standard_error(pipelines: Sequence[tuple[float, MeasuredPipeline]]) -> float:
    """Return the standard error of the log of the smallest error, the mean over its units."""
    if not pipelines:
        return 0.0
    _, row = min(pipelines, key=lambda found: found[0])
    units = max(len(row.unit_own_error_deg), 1)
    return stdev(map(math.log, row.unit_ratios)) / math.sqrt(units)
