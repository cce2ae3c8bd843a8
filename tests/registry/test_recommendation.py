"""Recommendations: what brute force over studies and rows gives, ranked as said."""

import dataclasses
import itertools
import math
import statistics
from collections.abc import Callable, Iterable, Mapping

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from registry.flows import chart
from registry.measured import Measured, Measurements
from registry.paths import PathTable
from registry.recommendation import recommend
from registry.studies import Facts, Study
from tests.speed.recommendations import worst_question

LEVELS = ("task", "detector", "mask", "model", "extractor")
VALUES = {
    "task": ["Accuracy", "Cost"],
    "error": ["Optical", "Alignment"],
    "accuracy": ["FSS", "CSS"],
    "detector": ["CMOS", "PD"],
    "mask": ["Slit", "Lens"],
    "model": ["SPM", "ECM", "ECM/Noise"],
    "extractor": ["BCTM", "Direct"],
    "accuracy_deg": ["0.01", "0.5", "2"],
    "fov_deg": ["60", "120"],
}
Rows = list[Mapping[str, list[str]]]
rows = st.lists(
    st.fixed_dictionaries(
        {
            a: st.lists(
                st.sampled_from(v),
                max_size=1 if a.endswith("_deg") else 2,
                min_size=1 if a in LEVELS else 0,
                unique=True,
            )
            for a, v in VALUES.items()
        }
    ),
    min_size=1,
    max_size=6,
)
numbers = st.none() | st.sampled_from([0.005, 0.01, 0.3, 1.0])
measured_rows = st.lists(
    st.builds(
        Measured,
        dataset=st.sampled_from(["d1", "d2"]),
        condition=st.just("nominal"),
        detector=st.sampled_from(VALUES["detector"]),
        mask=st.sampled_from(VALUES["mask"]),
        extractor=st.just("e"),
        extractor_taxonomy=st.sampled_from(VALUES["extractor"]),
        model=st.just("m"),
        model_taxonomy=st.sampled_from(["SPM", "ECM/Noise"]),
        rms_deg=numbers,
        half_fov_deg=st.none() | st.sampled_from([20.0, 30.0, 60.0]),
        latency_us=st.none() | st.sampled_from([1.0, 10.0]),
    ),
    max_size=8,
)
answers_to_ask = {
    **{
        prefix + a: st.lists(st.sampled_from(VALUES[a]), min_size=1, max_size=2, unique=True)
        for prefix in ("", "exclude_")
        for a in VALUES
        if not a.endswith("_deg")
    },
    "max_error_deg": st.sampled_from([0.004, 0.01, 0.5, 3.0]),
    "min_fov_deg": st.sampled_from([50.0, 120.0, 200.0]),
    "max_latency_us": st.sampled_from([0.5, 5.0, 50.0]),
}
asked = st.lists(st.sampled_from(list(answers_to_ask)), max_size=5, unique=True).flatmap(
    lambda names: st.fixed_dictionaries({name: answers_to_ask[name] for name in names})
)


def kinds(values: Iterable[str]) -> set[str]:
    return {k for v in values for k in ((v, "ECM/Noise") if v == "ECM" else (v,))}


def keeps(study: Study, row: Measured | None, limit: str, bound: float) -> bool:
    number = {
        "max_error_deg": study.number("accuracy_deg"),
        "min_fov_deg": study.number("fov_deg"),
        "max_latency_us": None,
    }[limit]
    if row is not None:
        full = None if row.half_fov_deg is None else 2 * row.half_fov_deg
        measured = {
            "max_error_deg": row.rms_deg,
            "min_fov_deg": full,
            "max_latency_us": row.latency_us,
        }[limit]
        number = number if measured is None else measured
    if number is None:
        return False
    return number >= bound if limit == "min_fov_deg" else number <= bound


def brute_force(
    facts: Facts, ask: Mapping[str, object], table: list[Measured]
) -> dict[tuple[str, ...], set[str]]:
    """Path -> studies, by asking every study, combination and row in turn."""
    found: dict[tuple[str, ...], set[str]] = {}
    paths = {
        path: None
        for study in facts.studies.values()
        for path in itertools.product(*(study.of(level) for level in LEVELS))
    }
    for path in paths:
        value_of = dict(zip(LEVELS, path, strict=True))
        on_route = sorted(
            (
                row
                for row in table
                if row.rms_deg is not None
                and (row.detector, row.mask) == path[1:3]
                and (row.model_taxonomy, row.extractor_taxonomy) == path[3:]
            ),
            key=lambda row: (row.rms_deg, row.dataset),
        )
        survivors: list[set[str]] = []
        for row in on_route or [None]:
            keys = set()
            for key, study in facts.studies.items():
                met = all(value_of[level] in study.of(level) for level in LEVELS)
                for name, wanted in ask.items():
                    if isinstance(wanted, list):
                        base = name.removeprefix("exclude_")
                        has = {value_of[base]} if base in LEVELS else set(study.of(base))
                        met &= bool(has & kinds(wanted)) != name.startswith("exclude_")
                    elif isinstance(wanted, float):
                        met &= keeps(study, row, name, wanted)
                if met:
                    keys.add(key)
            if keys:
                survivors.append(keys)
        if survivors:
            # Rows differ in which limits they leave to the studies; any that is met will do.
            found[path] = set().union(*survivors)
    return found


def path_of(path: object) -> tuple[str, ...]:
    return tuple(getattr(path, level) for level in LEVELS)


@pytest.mark.slow
@settings(deadline=None, derandomize=True, max_examples=200)
@given(table=rows, ask=asked, measured=measured_rows)
def test_paths_and_their_studies_are_those_brute_force_finds(
    facts_of: Callable[[Rows], Facts],
    table: Rows,
    ask: dict[str, object],
    measured: list[Measured],
) -> None:
    facts = facts_of(table)
    answer = recommend(ask, measured, facts=facts)
    expected = brute_force(facts, ask, measured)
    assert {path_of(p) for p in answer.paths} == set(expected)
    for path in answer.paths:
        assert set(path.studies) <= expected[path_of(path)]
        assert path.studies
        if path.measured is None:
            assert set(path.studies) == expected[path_of(path)]
        assert len(path.studies) == path.literature.studies
    assert answer.count == len(answer.paths)
    assert (answer.blocked is None) == bool(expected)


@settings(deadline=None, derandomize=True, max_examples=150)
@given(table=rows, ask=asked, measured=measured_rows)
def test_relaxations_give_the_paths_they_promise_and_nothing_smaller_does(
    facts_of: Callable[[Rows], Facts],
    table: Rows,
    ask: dict[str, object],
    measured: list[Measured],
) -> None:
    facts = facts_of(table)
    answer = recommend(ask, measured, facts=facts)
    if answer.blocked is None:
        return
    blocked = answer.blocked
    for relaxation in blocked.relaxations:
        relaxed = recommend(relaxation.apply(answer.requirements), measured, facts=facts)
        assert relaxed.count == relaxation.paths > 0
    first = blocked.relaxations[0]
    assert tuple(first.drop) == blocked.constraints
    for size in range(1, len(blocked.constraints) + 1):
        working = {
            names
            for names in itertools.combinations(answer.requirements.names, size)
            if recommend(answer.requirements.without(*names), measured, facts=facts).count
        }
        if size < len(blocked.constraints):
            assert not working
        else:
            offered = {tuple(r.drop) for r in blocked.relaxations if r.drop}
            assert offered <= working
            assert len(offered) == min(len(working), 10)


@settings(deadline=None, derandomize=True, max_examples=100)
@given(table=rows, measured=measured_rows, bound=st.sampled_from([0.004, 0.009]))
def test_the_changed_limit_is_the_strictest_that_gives_a_path(
    facts_of: Callable[[Rows], Facts], table: Rows, measured: list[Measured], bound: float
) -> None:
    facts = facts_of(table)
    answer = recommend({"max_error_deg": bound}, measured, facts=facts)
    changes = [r for r in answer.blocked.relaxations if r.change] if answer.blocked else []
    for relaxation in changes:
        limit = relaxation.change["max_error_deg"]
        assert isinstance(limit, float)
        just_below = {"max_error_deg": math.nextafter(limit, 0)}
        assert recommend(just_below, measured, facts=facts).count == 0


@settings(deadline=None, derandomize=True, max_examples=150)
@given(table=rows, ask=asked, measured=measured_rows)
def test_the_pareto_set_is_what_comparing_all_pairs_leaves(
    facts_of: Callable[[Rows], Facts],
    table: Rows,
    ask: dict[str, object],
    measured: list[Measured],
) -> None:
    answer = recommend(ask, measured, facts=facts_of(table))
    limits = [n for n in ("max_error_deg", "min_fov_deg", "max_latency_us") if n in ask]
    points = []
    for path in answer.paths:
        counts = path.literature
        merit = [float(counts.studies * counts.with_model * counts.architecture)]
        for limit in limits or ["max_error_deg"]:
            row = path.measured
            number = (
                row
                and {
                    "max_error_deg": row.rms_deg,
                    "min_fov_deg": row.half_fov_deg,
                    "max_latency_us": row.latency_us,
                }[limit]
            )
            sign = 1 if limit == "min_fov_deg" else -1
            merit.append(-math.inf if number is None else sign * number)
        points.append(merit)
    for path, merit in zip(answer.paths, points, strict=True):
        beaten = any(
            other != merit and all(o >= m for o, m in zip(other, merit, strict=True))
            for other in points
        )
        assert path.pareto == (not beaten)


@settings(deadline=None, derandomize=True, max_examples=100)
@given(table=rows, ask=asked, measured=measured_rows)
def test_rank_goes_by_support_then_measured_error(
    facts_of: Callable[[Rows], Facts],
    table: Rows,
    ask: dict[str, object],
    measured: list[Measured],
) -> None:
    facts = facts_of(table)
    answer = recommend(ask, measured, facts=facts)
    keys = [
        (
            -round(path.literature.support, 9),
            math.inf if path.measured is None else path.measured.rms_deg,
        )
        for path in answer.paths
    ]
    assert keys == sorted(keys)
    assert [path.rank for path in answer.paths] == list(range(1, answer.count + 1))
    again = recommend(ask, Measurements(reversed(measured)), facts=facts, limit=2)
    assert again.paths == answer.paths[:2]
    assert (again.count, again.nodes, again.links) == (answer.count, answer.nodes, answer.links)


def test_support_is_the_geometric_mean_of_distinct_studies_at_three_depths(survey: Facts) -> None:
    answer = recommend({"task": "Accuracy"}, facts=survey)
    for path in answer.paths:
        depths = [
            sum(
                all(getattr(path, level) in s.supported(level) for level in LEVELS[:end])
                and (not s.combined or (path.detector, path.mask) in s.combined)
                for s in survey.studies.values()
            )
            for end in (5, 4, 3)
        ]
        literature = path.literature
        assert depths == [literature.studies, literature.with_model, literature.architecture]
        assert literature.support == pytest.approx(statistics.geometric_mean(depths))


def test_a_lone_path_of_a_well_backed_architecture_ranks_above_an_isolated_one(
    facts_of: Callable[[Rows], Facts],
) -> None:
    backed = {"task": ["Cost"], "detector": ["PD"], "mask": ["Slit"], "model": ["LUT"]}
    isolated = {"task": ["Cost"], "detector": ["CCD"], "mask": ["Lens"], "model": ["LUT"]}
    facts = facts_of(
        [
            {**isolated, "extractor": ["BCM"]},
            {**backed, "extractor": ["Direct"]},
            {**backed, "extractor": ["Voltage balance"]},
        ]
    )
    assert [path.detector for path in recommend({}, facts=facts).paths] == ["PD", "PD", "CCD"]


def test_for_accuracy_cmos_with_multi_aperture_and_encoded_masks_is_among_the_first_ten(
    survey: Facts,
) -> None:
    # What the survey's cross-analysis recommends for accuracy; ten is a page of the answer.
    answer = recommend({"task": ["Accuracy"]}, limit=10, facts=survey)
    leading = {(path.detector, path.mask) for path in answer.paths}
    assert {("CMOS", "Multi-Ap."), ("CMOS", "Encoded")} <= leading
    assert answer.count > 50


def without_what_was_only_compared(facts: Facts) -> Facts:
    kept = {}
    for key, s in facts.studies.items():
        values = {
            attribute: tuple(c for c in cells if s.role(attribute, c.value) != "compared")
            for attribute, cells in s.values.items()
        }
        kept[key] = dataclasses.replace(s, values=values)
    return Facts(kept, facts.taxonomy)


def test_what_a_study_only_compared_is_none_of_its_support(survey: Facts) -> None:
    # Chang2007a and Chang2008 took basic centroids to show that a template is better.
    for key in ("Chang2007a", "Chang2008"):
        assert survey.studies[key].supported("extractor") == ("TM",)
    ask = {"detector": ["CMOS"], "mask": ["Single-Ap."], "model": ["SPM"]}
    paths = recommend({**ask, "task": ["Accuracy"]}, facts=survey).paths
    backing = {path.extractor: set(path.studies) for path in paths}
    assert {"Chang2007a", "Chang2008"} <= backing["TM"]
    assert backing["BCTM"] == {"ONeill2020", "Rhee2012"}
    assert "BCM" not in backing


def test_no_path_is_of_a_sensor_that_there_is_not(survey: Facts) -> None:
    paths = recommend({}, facts=survey).paths
    pairs = {(path.detector, path.mask) for path in paths}
    assert ("PDA", "N-Slit") in pairs
    assert not pairs & {("PDA", "Maskless"), ("PVA", "N-Slit")}


def test_nodes_and_links_are_the_cross_analysis_narrowed_to_the_answer(survey: Facts) -> None:
    ask = {"task": ["Accuracy"], "detector": ["CMOS"]}
    answer = recommend(ask, facts=survey)
    whole = chart("cross-analysis", ask, facts=without_what_was_only_compared(survey))
    wide = {(link.source, link.target): set(link.studies) for link in whole.links}
    narrow = {(link.source, link.target): set(link.studies) for link in answer.links}
    complete = {s.key for s in survey.studies.values() if all(s.of(level) for level in LEVELS)}
    assert narrow == {k: v & complete for k, v in wide.items() if v & complete}
    assert {n.id for n in answer.nodes} == {end for link in narrow for end in link}
    assert {left.level: len(left.studies) for left in answer.left_out} == {
        level: sum(not s.of(level) for s in survey.studies.values())
        for level in ("task", "detector", "mask")
    }


def test_the_worst_question_is_explained_by_a_few_answers(
    survey: Facts, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every parameter asked, nothing met: all subsets of 17 would be 131072 answers."""
    answers = []
    meeting = PathTable.meeting

    def counted(table: PathTable, *asked: object) -> object:
        answers.append(asked)
        return meeting(table, *asked)

    monkeypatch.setattr(PathTable, "meeting", counted)
    answer = recommend(worst_question(survey), facts=survey)
    assert answer.blocked is not None
    assert len(answer.blocked.constraints) > 1
    assert 1 < len(answers) < 300
