"""Recommendations from the survey's own studies and advice, with nothing measured."""

import dataclasses
import statistics
from collections.abc import Callable, Mapping

import pytest
from scores import pipeline

from registry.contradiction import calibration_name
from registry.flows import chart
from registry.judging import Question
from registry.recommendation import recommend
from registry.requirements import Requirements
from registry.studies import Facts
from tools.bench.recommendations import worst_question

LEVELS = ("task", "detector", "mask", "model", "extractor")
Rows = list[Mapping[str, list[str]]]


def test_support_is_the_geometric_mean_of_distinct_studies_at_three_depths(survey: Facts) -> None:
    answer = recommend({"task": "Accuracy"}, facts=survey)
    kinds = survey.taxonomy.kinds
    compared = 0
    for place in answer.architectures:
        pair = (place.detector, place.mask)
        there = [
            s
            for s in survey.studies.values()
            if pair in s.architectures and "Accuracy" in s.of("task")
        ]
        assert set(place.studies) == {s.key for s in there}
        for one in place.calibrations:
            with_model = [
                s
                for s in there
                if any(one.model in kinds("model", m) for m in s.has_value("model"))
            ]
            taken = [s for s in with_model if one.extractor in s.has_value("extractor")]
            assert set(one.studies) == {s.key for s in taken}
            depths = [len(there), len(with_model), len(taken)]
            assert one.with_model == depths[1]
            assert one.support == pytest.approx(statistics.geometric_mean(depths), abs=5e-5)
            compared += 1
    assert compared > 50


def test_architectures_are_named_once_each_and_so_are_their_calibrations(survey: Facts) -> None:
    answer = recommend({}, facts=survey)
    pairs = [(a.detector, a.mask) for a in answer.architectures]
    assert len(set(pairs)) == len(pairs) > 20
    for a in answer.architectures:
        ways = [(c.extractor, *c.compensations, c.model) for c in a.calibrations]
        assert len(set(ways)) == len(ways)


def test_advice_is_marked_for_what_is_asked_and_first_where_nothing_is_known(
    survey: Facts,
) -> None:
    published = {"Power", "Volume", "Cost"}  # of some, which go by that
    for task in survey.taxonomy.values("task"):
        answer = recommend({"task": task}, facts=survey)
        expected = {
            (a.detector, a.mask)
            for a in answer.architectures
            for advice in survey.advice
            if (advice.requirement, advice.value) == ("task", task)
            and advice.means((a.detector, a.mask))
        }
        marked = [bool(a.advice) for a in answer.architectures]
        assert task in published or marked == sorted(marked, reverse=True)
        assert {(a.detector, a.mask) for a in answer.architectures if a.advice} == expected
        assert expected
        assert all(entry["value"] == task for a in answer.architectures for entry in a.advice)


def test_what_is_advised_and_measured_needs_no_study_that_had_the_task(survey: Facts) -> None:
    """Advice alone makes an architecture one of a task, and the answer says that it is so."""
    alone = [
        (task, pair)
        for task in survey.taxonomy.values("task")
        for pair in {p for s in survey.studies.values() for p in s.architectures}
        if any(a.means(pair) and a.value == task for a in survey.advice)
        and not any(
            pair in s.architectures and task in s.of("task") for s in survey.studies.values()
        )
    ]
    assert alone
    for task, (detector, mask) in alone:
        row = pipeline(detector=detector, mask=mask)
        answer = recommend({"task": task}, [row], facts=survey)
        (found,) = (a for a in answer.architectures if (a.detector, a.mask) == (detector, mask))
        assert not found.studies
        assert found.advice
        assert {c.basis["task"] for c in found.calibrations} == {"advised"}
        others = [a for a in answer.architectures if a.studies]
        assert {c.basis["task"] for a in others for c in a.calibrations} == {"studies"}


def test_an_extractor_has_every_property_asked_for(survey: Facts) -> None:
    for name, marks in survey.properties.items():
        answer = recommend({"properties": name}, facts=survey)
        found = {c.extractor for a in answer.architectures for c in a.calibrations}
        assert found
        assert all(marks.get(extractor, 0) > 0 for extractor in found)
    both = list(survey.properties)[:2]
    narrow = recommend({"properties": both}, facts=survey).designs
    assert narrow <= min(recommend({"properties": [n]}, facts=survey).designs for n in both)


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
        assert survey.studies[key].has_value("extractor") == ("TM",)
    ask = {"detector": ["CMOS"], "mask": ["Single-Ap."], "model": ["SPM"], "task": ["Accuracy"]}
    (place,) = recommend(ask, facts=survey).architectures
    backing = {one.extractor: set(one.studies) for one in place.calibrations}
    assert {"Chang2007a", "Chang2008"} <= backing["TM"]
    assert backing["BCTM"] == {"ONeill2020", "Rhee2012"}
    assert "BCM" not in backing


def test_no_architecture_is_of_a_sensor_that_there_is_not(survey: Facts) -> None:
    answer = recommend({}, facts=survey)
    pairs = {(a.detector, a.mask) for a in answer.architectures}
    assert ("PDA", "N-Slit") in pairs
    assert not pairs & {("PDA", "Maskless"), ("PVA", "N-Slit")}


def test_nodes_and_links_are_the_cross_analysis_narrowed_to_the_answer(survey: Facts) -> None:
    ask = {"task": ["Accuracy"], "detector": ["CMOS"]}
    answer = recommend(ask, facts=survey)
    whole = chart("cross-analysis", ask, facts=without_what_was_only_compared(survey))
    wide = {(link.source, link.target): set(link.studies) for link in whole.links}
    narrow = {
        (link["source"], link["target"]): set(link["studies"]) for link in answer.document["links"]
    }
    complete = {s.key for s in survey.studies.values() if all(s.of(level) for level in LEVELS)}
    assert narrow == {k: v & complete for k, v in wide.items() if v & complete}
    assert {n["id"] for n in answer.document["nodes"]} == {end for link in narrow for end in link}
    assert {left["level"]: len(left["studies"]) for left in answer.document["left_out"]} == {
        level: sum(not s.of(level) for s in survey.studies.values())
        for level in ("task", "detector", "mask")
    }


def test_paths_are_the_values_that_studies_have_together(survey: Facts) -> None:
    answer = recommend({"detector": ["CMOS"]}, facts=survey)
    assert len(answer.document["paths"]) > 50
    for path in answer.document["paths"]:
        taken = {
            s.key
            for s in survey.studies.values()
            if all(path[level] in s.has_value(level) for level in LEVELS)
            and (path["detector"], path["mask"]) in s.architectures
        }
        assert set(path["studies"]) == taken


def test_equals_stand_in_the_order_of_the_taxonomy(
    survey: Facts, facts_of: Callable[[Rows], Facts]
) -> None:
    masks = survey.taxonomy.values("mask")
    same = {"task": ["Cost"], "detector": ["CMOS"], "model": ["SPM"], "extractor": ["BCTM"]}
    facts = facts_of([{**same, "mask": [mask]} for mask in reversed(masks)])
    answer = recommend({}, facts=facts)
    assert [a.mask for a in answer.architectures] == list(masks)
    assert [node["value"] for node in answer.document["nodes"] if node["level"] == "mask"] == list(
        masks
    )
    assert [
        link["target"] for link in answer.document["links"] if link["source"] == "detector:CMOS"
    ] == [f"mask:{mask}" for mask in masks]
    levels = [node["level"] for node in answer.document["nodes"]]
    assert tuple(dict.fromkeys(levels)) == LEVELS
    (detector,) = (node for node in answer.document["nodes"] if node["level"] == "detector")
    assert detector["studies"] == list(facts.studies)


def test_the_worst_question_is_explained_by_a_few_answers(
    survey: Facts, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every parameter asked, nothing met: all subsets of 20 would be a million answers."""
    answers = []
    count = Question.count

    def counted(question: Question) -> object:
        answers.append(question.requirements)
        return count(question)

    monkeypatch.setattr(Question, "count", counted)
    ask = worst_question(survey)
    assert set(Requirements.parse(ask, survey.taxonomy, survey.properties).names) == set(ask)
    answer = recommend(ask, facts=survey)
    assert answer.blocking_constraint is not None
    assert len(answer.blocking_constraint.constraints) > 1
    assert 1 < len(answers) < 300


@pytest.mark.parametrize(
    ("extractor", "stages", "measured", "name"),
    [
        ("BCTM", ("SPM",), ("bctm", "spm"), "bctm + spm"),
        ("None", ("SECM/Solar", "Camera"), ("mirror", "solar + camera"), "mirror + solar + camera"),
        ("BCTM", ("OCM", "LUT"), None, "BCTM + OCM + LUT (survey labels)"),
        ("None", ("None",), None, "no extraction + no model (survey labels)"),
    ],
)
def test_a_calibration_has_the_name_of_its_pipeline_or_else_the_survey_s_labels(
    extractor: str, stages: tuple[str, ...], measured: tuple[str, str] | None, name: str
) -> None:
    assert calibration_name(extractor, stages, measured) == name
