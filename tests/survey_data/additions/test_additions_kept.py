"""Studies the survey does not map: whole after a kill, by the rules, a version an edition."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import survey_data
from survey_data import facts_manifest
from survey_data.additions.writing import (
    add_study,
    read_study,
    remove_study,
    verify_study,
)
from survey_data.editions import editions
from survey_data.importing.writing import locked_tables
from survey_data.problems import SurveyImportError
from tests.survey_data.additions.offered_study import CONFIRMED, content, offered


def test_a_confirmation_stands_once_and_on_a_real_day(recorded: Path) -> None:
    row = {**CONFIRMED, "study": "Chang2008"}
    verify_study(row, recorded, apply=True)
    with pytest.raises(SurveyImportError, match="stands already"):
        verify_study(row, recorded, apply=True)
    with pytest.raises(SurveyImportError, match="expected a day, got '2030-02-30'"):
        verify_study({**row, "date": "2030-02-30"}, recorded, apply=True)


KILLED = """
import os, sys
from pathlib import Path
from survey_data.additions import writing
count, folder, path = int(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3])
def counted(real):
    def step(*given, **more):
        global count
        if any(str(each).startswith(str(folder)) for each in given):
            count -= 1
            if count == 0:
                os.kill(os.getpid(), 9)
        return real(*given, **more)
    return step
for name in ("replace", "rename", "unlink", "rmdir", "mkdir"):
    setattr(os, name, counted(getattr(os, name)))
writing.add_study(writing.read_study(path, folder), folder, apply=True)
"""


@pytest.mark.slow
def test_a_kill_between_any_two_steps_leaves_the_study_whole_or_away(recorded: Path) -> None:
    path = offered(recorded)
    begun = content(recorded)
    seen = set()
    for step in range(1, 60):
        root = str(Path(__file__).parents[3])
        ran = subprocess.run(
            [sys.executable, "-c", KILLED, str(step), str(recorded), str(path)],
            env={**os.environ, "PYTHONPATH": root},
            capture_output=True,
            check=False,
        )
        assert ran.returncode in (0, -signal.SIGKILL), ran.stderr
        with locked_tables(recorded):  # as the next that writes
            pass
        assert facts_manifest.changes(recorded) == []
        assert survey_data.validate(recorded) == []
        tables = survey_data.load(recorded)
        there = "Doe2030" in set(tables.extension_studies["key"])
        seen.add((there, ran.returncode))
        assert (tables.extension_attributes["study"] == "Doe2030").any() == there
        if there:
            remove_study("Doe2030", recorded, apply=True)
        else:
            addition = read_study(path, recorded)
            add_study(addition, recorded, apply=True)
            remove_study("Doe2030", recorded, apply=True)
        held = content(recorded).items()  # what is half made stays for a day
        assert {name: data for name, data in held if ".sunatlas" not in name} == begun
        if ran.returncode == 0:
            break
    assert seen >= {(False, -signal.SIGKILL), (True, -signal.SIGKILL), (True, 0)}


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


def test_tables_of_later_studies_have_the_columns_of_the_surveys() -> None:
    tables = survey_data.load()
    for name in ("studies", "attributes", "roles", "architectures"):
        later = getattr(tables, f"extension_{name}")
        assert list(later.columns) == list(getattr(tables, name).columns)
