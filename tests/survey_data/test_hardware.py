"""Built sensors: what the table says, as numbers that can be compared."""

from __future__ import annotations

import math
import shutil
from dataclasses import fields
from pathlib import Path

import pytest

import survey_data
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.hardware import Hardware, hardware
from survey_data.problems import SurveyDataError


def sensor(**given: object) -> Hardware:
    empty: dict[str, object] = dict.fromkeys((field.name for field in fields(Hardware)), "")
    figures = dict.fromkeys(("fov_full_deg", "accuracy_deg", "precision_deg"))
    return Hardware(**{**empty, **figures, **given})


def test_it_is_the_table_that_pandas_reads() -> None:
    frame = survey_data.load().hardware
    found = hardware()
    assert list(found) == frame["id"].tolist()
    for column in ("fov_full_deg", "accuracy_deg", "precision_deg"):
        ours = [getattr(item, column) for item in found.values()]
        theirs = [None if math.isnan(value) else value for value in frame[column].tolist()]
        assert ours == theirs
    assert {item.basis for item in found.values()} == {"page", "recalled"}


@pytest.mark.parametrize(
    ("kind", "rms"), [("3sigma", 0.1), ("max", 0.1), ("1sigma", 0.3), ("rms", 0.3), ("", 0.3)]
)
def test_claims_are_compared_as_root_mean_squares(kind: str, rms: float) -> None:
    assert sensor(accuracy_deg=0.3, accuracy_kind=kind).rms_deg == pytest.approx(rms)
    assert sensor(accuracy_kind=kind).rms_deg is None


def test_a_broken_table_is_named(tmp_path: Path) -> None:
    with pytest.raises(SurveyDataError, match=r"hardware\.csv"):
        hardware(tmp_path)
    shutil.copy(DATA_DIRECTORY / "hardware.csv", tmp_path)
    assert list(hardware(tmp_path)) == list(hardware())
