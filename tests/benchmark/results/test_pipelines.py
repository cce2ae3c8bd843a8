"""Stored scores as recommendations take them: pipelines, hazards, cones, units."""

import math

import pytest

from benchmark import datasets
from benchmark.datasets.hazards import TRIED, hazards
from benchmark.metrics.score import METRICS
from benchmark.results.pipelines import pipelines
from benchmark.results.store import Store
from registry.measured_pipelines import Measurements
from registry.recommendation import recommend
from registry.requirements import HAZARDS
from registry.studies import facts

CMOS = "cmos-single-aperture"


def row(condition="nominal", unit=0, **changed):
    numbers = dict.fromkeys(METRICS, 0.25) | {"rms_deg": 0.5, "availability": 1.0}
    numbers["rms_all_answers_deg"] = changed.get("rms_deg", 0.5)
    return {
        "dataset": CMOS,
        "detector": "CMOS",
        "mask": "Single-Ap.",
        "extractor": "bctm",
        "extractor_taxonomy": "BCTM",
        "model": "spm",
        "half_fov_deg": 60.0,
        "condition": condition,
        "unit": unit,
        **numbers,
        **changed,
    }


def test_rows_of_a_pipeline_become_one():
    names = datasets.get(CMOS).conditions
    rows = [row(), row(unit=2, rms_deg=0.3), row(unit=1, rms_deg=0.4), row(unit=3, rms_deg=None)]
    rows += [row(name, rms_deg=2.0) for name in names[1:]]
    (found,) = pipelines(rows, {(CMOS, "bctm", "spm"): 7.0})
    assert found.nominal.condition == names[0]
    assert found.unit_own_error_deg == (0.5, 0.4, 0.3)
    middle = (0.5 * 0.4 * 0.3) ** (1 / 3)
    assert found.nominal.rms_deg == float(f"{middle:.5g}")  # as boards have it
    assert found.latency_us == 7.0
    assert found.stages == ("SPM",)
    tried = hazards(names)
    assert {h: tuple(s.condition for s in scores) for h, scores in found.hazards.items()} == tried
    errors = [s.rms_deg for scores in found.hazards.values() for s in scores]
    assert errors == pytest.approx([2.0 * middle / 0.5] * len(errors)), "scaled as the units are"


def test_a_hazard_is_tried_by_all_of_its_conditions_or_not():
    dataset, hazard, names = next(
        (name, hazard, found)
        for name in datasets.names()
        for hazard, found in hazards(datasets.get(name).conditions).items()
        if len(found) > 1 and datasets.get(name).conditions[0] not in found
    )
    first = row(datasets.get(dataset).conditions[0], dataset=dataset)
    tried = [row(name, dataset=dataset) for name in names]
    (whole,) = pipelines([first, *tried])
    assert whole.covers(hazard)
    (part,) = pipelines([first, *tried[:-1]])
    assert not part.covers(hazard)


def test_what_there_is_no_longer_and_what_has_no_first_condition_is_passed_over():
    gone = [row(dataset="gone"), row(model="gone"), row(condition="hot", extractor="bcm")]
    assert [found.extractor for found in pipelines([row(), *gone])] == ["bctm"]


def test_cones_reach_to_the_field_and_no_further():
    rings = {"rms_0_10_deg": 0.1, "rms_10_20_deg": 0.3, "rms_20_30_deg": None}
    (found,) = pipelines([row(half_fov_deg=25.0, **rings)])
    halves = [half for half, _ in found.nominal.cones]
    assert halves == [10.0, 20.0, 25.0]
    errors = [error for _, error in found.nominal.cones]
    assert errors[0] == pytest.approx(0.1)
    # Rings count by their solid angle.
    near, both = (1.0 - math.cos(math.radians(angle)) for angle in (10.0, 20.0))
    expected = math.sqrt((0.01 * near + 0.09 * (both - near)) / both)
    assert errors[1] == pytest.approx(expected)
    assert errors[2] is None


def test_a_data_set_without_a_field_of_its_own_covers_the_sphere():
    (found,) = pipelines([row(half_fov_deg=None)])
    assert found.half_fov_deg == 180.0
    assert found.nominal.cones[-1][0] == 180.0
    answer = recommend({"min_fov_deg": 360.0, "max_error_deg": 1.0}, Measurements([found]))
    measured = [a.place.architecture for a in answer.architectures if "measured" in a.meets]
    assert measured == [("CMOS", "Single-Ap.")]


def test_hazards_are_those_that_may_be_asked_for_and_their_conditions_exist():
    assert set(TRIED) == set(HAZARDS)
    named = {name for d in datasets.names() for name in datasets.get(d).conditions}
    assert {name for names in TRIED.values() for name in names} <= named
    # Where the Earth's light is left out of one condition, it is in the first.
    assert hazards(("nominal", "no-albedo"))["albedo"] == ("nominal",)
    assert "albedo" not in hazards(("nominal", "hot"))


@pytest.fixture(scope="module")
def published():
    return Measurements(pipelines(Store().rows(unit=None)))


def test_architectures_advised_for_a_task_are_in_its_answer_and_marked(published):
    known = facts()
    every = {a.place.architecture for a in recommend({}, published).architectures}
    for task in known.taxonomy.values("task"):
        advice = [a for a in known.advice if (a.requirement, a.value) == ("task", task)]
        advised = {pair for pair in every if any(a.means(pair) for a in advice)}
        assert advised, task
        found = recommend({"task": task}, published).architectures
        marked = {a.place.architecture for a in found if a.evidence["task"][2] == "meets"}
        assert marked == advised, task


def test_albedo_changes_the_order_of_errors_of_coarse_sensors(published):
    def order(**asked):
        found = recommend({"mask": "Maskless", "level": "own", **asked}, published, sort="error")
        measured = [a for a in found.architectures if "measured" in a.meets]
        errors = {a.place.architecture: a.best.own.error_deg for a in measured}
        return sorted(errors, key=errors.get), errors

    clear, without = order()
    lit, under = order(tolerate=["albedo"])
    assert set(lit) <= set(clear)
    assert [d for d in clear if d in lit] != lit
    assert all(under[d] >= without[d] for d in lit)


def test_an_error_over_a_field_is_met_by_distinct_architectures_each_with_its_field(published):
    answer = recommend({"max_error_deg": 0.02, "min_fov_deg": 100.0}, published)
    measured = [a for a in answer.architectures if "measured" in a.meets]
    assert len({a.place.architecture for a in measured}) == len(measured) > 1
    for one in measured:
        assert one.best.judged_deg <= 0.02
        assert one.best.own.field_deg >= 100.0
