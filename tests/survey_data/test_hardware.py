"""Built sensors: what the table says, as numbers that can be compared."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import pytest

import survey_data
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.hardware import hardware
from survey_data.problems import SurveyDataError


def test_it_is_the_table_that_pandas_reads() -> None:
    frame = survey_data.load().hardware
    found = hardware()
    assert list(found) == frame["id"].tolist()
    for column in ("fov_full_deg", "accuracy_deg", "precision_deg"):
        ours = [getattr(item, column) for item in found.values()]
        theirs = [None if math.isnan(value) else value for value in frame[column].tolist()]
        assert ours == theirs
    assert {item.basis for item in found.values()} == {"page", "recalled"}


def test_a_broken_table_is_named(tmp_path: Path) -> None:
    with pytest.raises(SurveyDataError, match=r"hardware\.csv"):
        hardware(tmp_path)
    shutil.copy(DATA_DIRECTORY / "hardware.csv", tmp_path)
    assert list(hardware(tmp_path)) == list(hardware())
