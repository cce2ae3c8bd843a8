"""What a table or a bibliography states wrongly is refused with its place; the rest is read."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import survey_data
from files.manifest import FILE
from survey_data import SurveyImportError, import_table, read_table
from survey_data.importing.studies import StudyFinder, StudyNotFoundError
from survey_data.importing.values import ValueReader


@pytest.fixture
def usual_csv_limit() -> Iterator[None]:
    """Python's own limit on a cell: a library that validates tables lifts it for the process."""
    before = csv.field_size_limit(131_072)
    yield
    csv.field_size_limit(before)


@pytest.mark.usefixtures("usual_csv_limit")
@pytest.mark.parametrize(
    ("text", "row", "said"),
    [
        ("K" * 1_000_001 + ",Mask\nA,B\n", 1, "the header is longer than 1000000 characters"),
        ("Key,Mask\nA,B" + "," * 300_000 + "\n", 2, "more than 300000 cells"),
        ("K" * 140_000 + ",Mask\nA,B\n", 1, "broken CSV: field larger than field limit"),
        ("Key\n" + "A\n" * 20_000, None, r"theirs\.csv has more than 20000 rows"),
    ],
)
def test_a_table_beyond_a_limit_is_refused_with_the_limit(
    text: str, row: int | None, said: str, tmp_path: Path
) -> None:
    path = tmp_path / "theirs.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SurveyImportError, match=said) as caught:
        read_table(path)
    assert caught.value.row == row


def test_empty_columns_behind_the_last_named_one_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "theirs.csv"
    path.write_text("Key,Mask,,\nAlvi2014,Slit,,\n", encoding="utf-8")
    frame = read_table(path)
    assert frame.to_dict("list") == {"Key": ["Alvi2014"], "Mask": ["Slit"]}


@pytest.mark.parametrize(
    ("attribute", "text", "expected"),
    [
        ("detector", "CMOS, n/a; PD", ["CMOS", "PD"]),
        (
            "accuracy",
            "Coarse, Fine sun sensor (better than 0.5 deg, down to about one arcminute)",
            ["CSS", "FSS"],
        ),
    ],
)
def test_a_list_is_cut_outside_parentheses_and_what_is_not_stated_left_out(
    attribute: str, text: str, expected: list[str], tables: survey_data.SurveyTables
) -> None:
    assert ValueReader(tables).read(attribute, text) == expected


@pytest.fixture(scope="module")
def finder(tables: survey_data.SurveyTables) -> StudyFinder:
    """A finder that knows a second study of one title, and one whose key has no year."""
    known = tables.studies.dropna(subset=["title"])
    one = known[known["key"] == "Mobasser2001"]
    more = [
        one.assign(key="Other2001"),
        one.assign(key="Timeless", title="A sundial of polished brass"),
    ]
    studies = pd.concat([tables.studies, *more], ignore_index=True)
    return StudyFinder(replace(tables, studies=studies))


def test_a_title_of_two_studies_is_not_guessed(finder: StudyFinder) -> None:
    with pytest.raises(StudyNotFoundError, match="may mean Mobasser2001 or Other2001"):
        finder.find(title="Fuzzy image processing in sun sensors")


def test_an_import_beside_a_damaged_manifest_writes_nothing(copy: Any) -> None:
    (copy.directory / FILE).write_text("{}\n", encoding="utf-8")
    path = copy.directory / "theirs.txt"
    path.write_text("Key;Mask\nAlvi2014;Lens\n", encoding="utf-8")
    before = copy.path("attributes").read_bytes()
    with pytest.raises(SurveyImportError, match=r"checksums-sha256.txt, line 1: expected 64"):
        import_table(path, copy.directory, apply=True)
    assert copy.path("attributes").read_bytes() == before
