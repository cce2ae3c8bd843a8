"""Designs of the survey, and the decision flow behind an answer, with nothing measured."""

import dataclasses

import pytest

from registry.designs import gather
from registry.flows import chart
from registry.measured_pipelines import Measurements
from registry.paths import PATH_LEVELS, answer_flow
from registry.recommendation import recommend
from registry.studies import Facts


def without_what_was_only_compared(facts: Facts) -> Facts:
    kept = {}
    for key, study in facts.studies.items():
        values = {
            attribute: tuple(c for c in cells if study.role(attribute, c.value) != "compared")
            for attribute, cells in study.values.items()
        }
        kept[key] = dataclasses.replace(study, values=values)
    return Facts(kept, facts.taxonomy)


def test_designs_are_named_once_with_the_studies_that_use_them(survey: Facts) -> None:
    places = gather(survey, Measurements())
    assert len({place.architecture for place in places}) == len(places) > 20
    compared = 0
    for place in places:
        assert len({(d.extractor, d.stages) for d in place.designs}) == len(place.designs)
        for design in place.designs:
            with_model = {
                key
                for key, study in place.studies.items()
                if any(
                    design.model in survey.taxonomy.kinds("model", model)
                    for model in study.has_value("model")
                )
            }
            assert design.with_model == with_model
            assert design.users == {
                key
                for key in with_model
                if design.extractor in place.studies[key].has_value("extractor")
            }
            compared += 1
    assert compared > 50


def test_what_a_study_only_compared_is_not_what_it_uses(survey: Facts) -> None:
    # Chang2007a and Chang2008 took basic centroids to show that a template is better.
    ask = {"detector": ["CMOS"], "mask": ["Single-Ap."], "model": ["SPM"], "task": ["Accuracy"]}
    (place,) = recommend(ask, facts=survey).architectures
    users = {d.extractor: d.users for d in place.place.designs if d.stages == ("SPM",)}
    assert users["TM"] >= {"Chang2007a", "Chang2008"}
    assert users["BCTM"] >= {"ONeill2020", "Rhee2012"}
    assert not {"Chang2007a", "Chang2008"} & (users["BCTM"] | users.get("BCM", frozenset()))


def test_no_architecture_is_of_a_sensor_that_there_is_not(survey: Facts) -> None:
    pairs = {one.place.architecture for one in recommend({}, facts=survey).architectures}
    assert ("PDA", "N-Slit") in pairs
    assert not pairs & {("PDA", "Maskless"), ("PVA", "N-Slit")}


def test_an_extractor_has_every_property_asked_for(survey: Facts) -> None:
    for name, marks in survey.properties.items():
        answer = recommend({"properties": name}, facts=survey)
        found = {
            calibration.design.extractor
            for one in answer.architectures
            for calibration in answer.calibrations(one)
        }
        assert found
        assert all(marks.get(extractor, 0) > 0 for extractor in found)


def test_paths_are_the_values_that_studies_have_together(survey: Facts) -> None:
    flow = answer_flow(recommend({"detector": ["CMOS"]}, facts=survey))
    assert len(flow.paths) > 50
    for path, studies in flow.paths.items():
        values = dict(zip(PATH_LEVELS, path, strict=True))
        assert set(studies) == {
            s.key
            for s in survey.studies.values()
            if all(values[level] in s.has_value(level) for level in PATH_LEVELS)
            and (values["detector"], values["mask"]) in s.architectures
        }


def test_nodes_and_links_are_the_cross_analysis_narrowed_to_the_answer(survey: Facts) -> None:
    ask = {"task": ["Accuracy"], "detector": ["CMOS"]}
    flow = answer_flow(recommend(ask, facts=survey))
    whole = chart("cross-analysis", ask, facts=without_what_was_only_compared(survey))
    wide = {(link.source, link.target): set(link.studies) for link in whole.links}
    complete = {s.key for s in survey.studies.values() if all(map(s.of, PATH_LEVELS))}
    narrow = {(link.source, link.target): set(link.studies) for link in flow.links}
    assert narrow == {k: v & complete for k, v in wide.items() if v & complete}
    assert {node.id for node in flow.nodes} == {end for link in narrow for end in link}
    assert {left.level: len(left.studies) for left in flow.left_out} == {
        level: sum(not s.of(level) for s in survey.studies.values())
        for level in ("task", "detector", "mask")
    }


def test_a_study_is_shared_out_so_that_what_flows_in_flows_out(survey: Facts) -> None:
    answer = recommend({"detector": ["CMOS"]}, facts=survey)
    for grouped in (False, True):
        flow = answer_flow(answer, "fractional", grouped=grouped)
        whole = answer_flow(answer, grouped=grouped)
        studies = {study for node in flow.nodes for study in node.studies}
        for level in flow.levels:
            assert sum(n.count for n in flow.nodes if n.level == level) == pytest.approx(
                len(studies)
            )
        for node in flow.nodes:
            into = sum(link.value for link in flow.links if link.target == node.id)
            out = sum(link.value for link in flow.links if link.source == node.id)
            ends = (flow.levels[0], flow.levels[-1])
            assert node.level == ends[0] or into == pytest.approx(node.count)
            assert node.level == ends[1] or out == pytest.approx(node.count)
        assert [set(n.studies) for n in flow.nodes] == [set(n.studies) for n in whole.nodes]
        assert all(n.count == len(n.studies) for n in whole.nodes)
    families = {n.value for n in whole.nodes if n.level == "model_category"}
    models = {survey.taxonomy.derived_values("model_category", path[3]) for path in whole.paths}
    assert families == models


def test_an_impossible_question_has_no_flow(survey: Facts) -> None:
    ask = {"task": ["Accuracy"], "detector": ["Event"], "mask": ["V-Slit"]}
    flow = answer_flow(recommend(ask, facts=survey))
    assert (flow.paths, flow.nodes, flow.links) == ({}, (), ())


def test_what_is_not_measured_stands_for_a_study_whose_method_is_not(
    survey: Facts, published: Measurements
) -> None:
    """A method that a study uses is a row of its own only where no measured one is of its kind."""
    alone = 0
    for place in gather(survey, published):
        measured = [design for design in place.designs if design.rows]
        for design in place.designs:
            if design.rows or len(design.stages) > 1 or not design.is_specified:
                continue
            kinds = set(survey.taxonomy.kinds("model", design.model))
            served = {
                key
                for other in measured
                if other.extractor == design.extractor and kinds & set(other.stages)
                for key in other.users
            }
            assert design.users - served, (place.architecture, design.extractor, design.model)
            alone += 1
    assert alone > 5
