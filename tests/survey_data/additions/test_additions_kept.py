"""Studies the survey does not map: whole after a kill, by the rules, a version an edition."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import survey_data
from survey_data.additions.writing import (
    add_study,
    read_study,
    verify_study,
)
from survey_data.editions import editions
from survey_data.problems import SurveyImportError
from tests.survey_data.additions.offered_study import CONFIRMED, offered


def test_a_confirmation_stands_once_and_on_a_real_day(recorded: Path) -> None:
    row = {**CONFIRMED, "study": "Chang2008"}
    verify_study(row, recorded, apply=True)
    with pytest.raises(SurveyImportError, match="stands already"):
        verify_study(row, recorded, apply=True)
    with pytest.raises(SurveyImportError, match="expected a day, got '2030-02-30'"):
        verify_study({**row, "date": "2030-02-30"}, recorded, apply=True)


def test_an_edition_has_another_version_when_a_cell_of_it_changes(recorded: Path) -> None:
    survey, later = editions(recorded)
    assert (survey.studies, later.studies) == (
        129,
        len(survey_data.load(recorded).extension_studies),
    )
    add_study(read_study(offered(recorded), recorded), recorded, apply=True)
    again, more = editions(recorded)
    assert again == survey
    assert more.studies == later.studies + 1
    assert more.version != later.version


@pytest.mark.parametrize(
    "faults",
    [
        [("studies", "key", "Chang2008", "a study of the survey")],  # other rows name it
        [
            ("studies", "doi", "10.1016/j.sna.2006.05.037", "Chang2006 of the survey"),
            ("studies", "year", "1999", "the key"),
            ("attributes", "value", "Sundial", "unknown taxonomy value"),
            ("attributes", "basis", "survey-text", "of a study outside the survey"),
            ("roles", "value", "Fourier", "has no"),
            ("names", "value", "Fourier", "has no"),
        ],
    ],
)
def test_rules_hold_for_later_studies_and_name_their_file(
    copy: Any, faults: list[tuple[str, str, str, str]]
) -> None:
    for table, column, text, _ in faults:
        copy.set(f"extension_{table}", 2, column, text)
    found = [p for p in survey_data.validate(copy.directory) if p.row == 2]
    for table, _, _, said in faults:
        assert [p for p in found if p.file == f"extension/{table}.csv" and said in p.message], found
