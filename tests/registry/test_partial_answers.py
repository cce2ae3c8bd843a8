"""A pipeline that answers too seldom has an error over what it answers, where one is known."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest
from scores import pipeline

from registry import pipelines
from registry.contradiction import against_literature
from registry.designs import Candidate, Design
from registry.measured_pipelines import MeasuredPipeline, Score
from registry.pipelines import NOT_COUNTED, PipelineTable

SELDOM: Mapping[str, object] = {"is_available": False, "availability": 0.7}
REFUSED = Score("bad", None)


@pytest.mark.parametrize(
    ("changed", "hazards", "half_field_deg", "expected"),
    [
        ({}, (), None, None),  # answers often enough
        (SELDOM, (), None, (0.1, 0.7)),
        (SELDOM, (), 60.0, (0.1, 0.7)),
        (SELDOM, (), 60.1, None),  # its data set does not have the field
        ({**SELDOM, "half_fov_deg": None}, (), 1.0, None),
        (SELDOM, ("albedo",), None, None),  # it has no condition with the hazard
        ({**SELDOM, "rms_deg": None}, (), None, None),  # refused
        ({**SELDOM, "hazards": {"albedo": (REFUSED,)}}, ("albedo",), None, None),
        ({**SELDOM, "availability": None}, (), None, None),
        (
            {**SELDOM, "hazards": {"albedo": (Score("bad", 0.4, availability=0.5),)}},
            ("albedo",), None, (0.4, 0.5),
        ),
    ],
)  # fmt: skip
def test_a_partial_answer_is_the_largest_error_over_what_is_answered(
    changed: Mapping[str, object],
    hazards: tuple[str, ...],
    half_field_deg: float | None,
    expected: tuple[float, float] | None,
) -> None:
    row = pipeline(**changed)
    found = row.partial_answer(hazards, half_field_deg)
    assert (None if found is None else (found.error_deg, found.availability)) == expected
    assert found is None or found.subject is row


def table(*rows: MeasuredPipeline) -> PipelineTable:
    return PipelineTable(rows, np.zeros(len(rows), int), np.arange(len(rows)))


#: Errors over 10, 30 and 60 deg, so that each field has another.
CONES = ((10.0, 0.01), (30.0, 0.02), (60.0, 0.04))


def test_units_are_counted_where_there_is_a_limit_and_an_error() -> None:
    rows = table(pipeline(unit_ratios=(0.5,) * 4 + (2.0,) * 6), pipeline(**SELDOM))
    drawn = rows.errors((), None, (0.0, 0.9))
    assert drawn.units_within(0.1).tolist() == [4, NOT_COUNTED]
    assert drawn.units_within(None).tolist() == [NOT_COUNTED] * 2
    assert rows.errors((), None).units_within(0.1).tolist() == [NOT_COUNTED] * 2


def test_errors_at_a_confidence_are_the_same_however_few_fields_are_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    halves, draws = (5.0, 20.0, 50.0, 5.0), (0.02, 0.9)
    rows = (pipeline(cones=CONES), pipeline(rms_deg=0.2, cones=CONES[1:]))
    fresh = [table(*rows).errors((), half, draws).error_deg.tolist() for half in halves]
    monkeypatch.setattr(pipelines, "MOST_FIELDS", 1)
    few = table(*rows)
    assert [few.errors((), half, draws).error_deg.tolist() for half in halves] == fresh
    assert len({tuple(errors) for errors in fresh}) == 3


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"rms_deg": None}, "no error over the required field of view and conditions"),
        ({"availability": None}, "no error over the required field of view and conditions"),
        (SELDOM, "0.1 deg RMS at 70 % availability, which is too low"),
    ],
)
def test_the_usual_calibration_without_an_error_says_why_the_other_is_better(
    changed: Mapping[str, object], said: str
) -> None:
    row, other = pipeline(**{"is_available": False, **changed}), pipeline(model="lut")
    design = Design(("CMOS", "Slit"), "BCTM", ("SPM",), 7, 7, (row,), ())
    usual = Candidate(design, row, row.judge())
    assert math.isinf(usual.error_deg)
    words = against_literature(usual, 3, Candidate(design, other, other.judge()), 1)
    assert words is not None
    assert words.startswith(f"3 studies used bctm + spm: {said}; bctm + lut, used by 1 study,")
    assert "reaches 0.1 deg RMS over 120 deg" in words
