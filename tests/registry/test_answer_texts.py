"""What an answer says of pipelines is what was measured, however its text was put together."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable, Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scores import STUDY, pipeline

from registry.answer_json import prepare
from registry.design_arrays import design_arrays
from registry.designs import design_table
from registry.draws import unit_errors
from registry.measured_pipelines import Measurements, Score
from registry.pipelines import NOT_COUNTED, PipelineTable
from registry.recommendation import recommend
from registry.studies import Facts
from registry.texts import calibrations
from registry.texts.calibrations import CalibrationTexts

FactsOf = Callable[[list[Mapping[str, list[str]]]], Facts]
RARE: Mapping[str, object] = {"is_available": False, "availability": 0.2}
#: Of ten units; some err alike.
RATIOS = (0.5, 0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.3, 1.7, 2.0)


@given(
    st.lists(st.sampled_from((0.01, 0.1, 0.3)), min_size=1, max_size=5),
    st.sampled_from((0.0, 0.02)),
    st.integers(0, 9),
    st.floats(1e-3, 1.0),
)
def test_units_are_counted_as_errors_are_compared(
    rms_deg: list[float], bench_deg: float, unit: int, limit_deg: float
) -> None:
    """A unit whose error is the limit itself keeps it."""
    rows = tuple(pipeline(rms_deg=rms, unit_ratios=RATIOS) for rms in rms_deg)
    table = PipelineTable(rows, np.zeros(len(rows), int), np.arange(len(rows)))
    own, ratios = np.array(rms_deg), np.array([RATIOS] * len(rows))
    kept = unit_errors(own, ratios, np.full(len(rows), bench_deg), 0.9)
    drawn = table.errors((), None, (bench_deg, 0.9))
    for limit in (limit_deg, float(kept[0, unit])):
        assert drawn.units_within(limit).tolist() == (kept <= limit).sum(axis=1).tolist()


def test_units_are_told_of_pipelines_whose_units_are_known(facts_of: FactsOf) -> None:
    """Of three data sets the units of one are not known, and one gives no answer."""
    rows = [
        pipeline(dataset="b", unit_own_deg=(0.1, 0.2), unit_ratios=RATIOS),
        pipeline(dataset="a", rms_deg=0.2),
        pipeline(dataset="c", unit_own_deg=(0.3,), **RARE),
        pipeline(dataset="d", rms_deg=0.15, unit_own_deg=(0.15,), unit_ratios=RATIOS),
    ]
    asked = {"max_error_deg": 0.25, "bench_deg": 0.0, "confidence": 0.5}
    document = recommend(asked, rows, facts=facts_of([STUDY])).document
    (found,) = document["architectures"][0]["calibrations"]
    units = {of["dataset"]: of["units"] for of in (found["measured"], *found["other_datasets"])}
    kept = unit_errors(np.array([0.1, 0.15]), np.array([RATIOS] * 2), np.zeros(2), 0.5) <= 0.25
    assert units["a"] is None
    assert {name: units[name]["within_limit"] for name in "bcd"} == {
        "b": kept[0].sum(),
        "c": None,
        "d": kept[1].sum(),
    }
    assert found["measured"]["units"] == units["b"]


def test_a_finer_pipeline_is_named_beside_those_that_err_more_than_three_times_as_much(
    facts_of: FactsOf,
) -> None:
    seldom = {"is_available": False, "availability": 0.7, "model": "lut", "stages": ("LUT",)}
    rows = [
        pipeline(dataset="a", rms_deg=0.1),
        pipeline(dataset="b", rms_deg=0.4),
        pipeline(dataset="c", **RARE),
        pipeline(dataset="a", rms_deg=0.05, **seldom),
    ]
    document = recommend({"model": ["SPM"]}, rows, facts=facts_of([STUDY])).document
    (found,) = document["architectures"][0]["calibrations"]
    assert all(of["finer"] is None for of in (found["measured"], *found["other_datasets"]))
    document = recommend({}, rows, facts=facts_of([STUDY])).document
    (found,) = [
        one for one in document["architectures"][0]["calibrations"] if one["model"] == "SPM"
    ]
    finer = {of["dataset"]: of["finer"] for of in (found["measured"], *found["other_datasets"])}
    assert finer["a"] is None
    assert finer["c"] is None
    assert finer["b"]["model"] == "lut"
    assert finer["b"]["error_deg"] == 0.05


def test_no_more_pipelines_are_written_beforehand_than_are_kept(
    facts_of: FactsOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    cones = ((10.0, 0.01), (30.0, 0.02))
    rows = [
        pipeline(extractor=name, extractor_taxonomy=name, cones=cones) for name in ("BCTM", "FEIC")
    ]
    facts = facts_of([STUDY])
    fresh = recommend({"min_fov_deg": 40.0}, rows, facts=facts).document
    written = []
    monkeypatch.setattr(calibrations, "MOST_PIPELINES", 3)
    write = CalibrationTexts._pipeline_text

    def counted(self: CalibrationTexts, design: int, row: int, errors: object) -> object:
        written.append(design)
        return write(self, design, row, errors)  # type: ignore[arg-type]

    monkeypatch.setattr(CalibrationTexts, "_pipeline_text", counted)
    kept = Measurements(rows)
    table = design_table(facts, kept)
    CalibrationTexts(design_arrays(table), calibrations.StudyTexts(facts.keys)).prepare()
    assert len(written) == 3
    prepare(table)
    assert recommend({"min_fov_deg": 40.0}, kept, facts=facts).document == fresh


def test_a_pipeline_without_an_error_has_no_count() -> None:
    rows = (pipeline(rms_deg=None), pipeline(hazards={"albedo": (Score("bad", None),)}))
    table = PipelineTable(rows, np.zeros(2, int), np.arange(2))
    assert (
        table.errors(("albedo",), None, (0.0, 0.9)).units_within(1.0).tolist() == [NOT_COUNTED] * 2
    )


@pytest.mark.parametrize("rows", [[], [pipeline(rms_deg=None)]])
def test_nothing_measured_can_be_prepared_for(rows: list[object], facts_of: FactsOf) -> None:
    facts, kept = facts_of([STUDY]), Measurements(rows)
    fresh = recommend({"max_error_deg": 1.0}, list(rows), facts=facts).document
    prepare(design_table(facts, kept))
    assert recommend({"max_error_deg": 1.0}, kept, facts=facts).document == fresh


def test_what_is_kept_of_measurements_goes_with_them(facts_of: FactsOf) -> None:
    """As after an import, where others take their place."""
    facts, measured = facts_of([STUDY]), Measurements([pipeline()])
    recommend({}, measured, facts=facts)
    table = weakref.ref(design_table(facts, measured))
    del measured
    gc.collect()
    assert table() is None
