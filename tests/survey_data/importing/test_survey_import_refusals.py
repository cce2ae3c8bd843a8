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
from files.locks import lock_path
from files.manifest import FILE
from survey_data import SurveyImportError, import_table, read_table
from survey_data.importing.bibliography import read_bibliography
from survey_data.importing.studies import StudyFinder, StudyNotFoundError
from survey_data.importing.values import UnreadableValueError, ValueReader
from survey_data.importing.writing import locked_tables


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


def entries(folder: Path, text: str) -> dict[str, tuple[str, str]]:
    """Return title and venue of each entry of a bibliography by key."""
    path = folder / "refs.bib"
    path.write_text(text, encoding="utf-8")
    return {each.key: (each.title, each.venue) for each in read_bibliography(path)}


def test_a_bibliography_that_is_no_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        SurveyImportError, match=r"cannot read .*: expected a file, got a directory"
    ):
        read_bibliography(tmp_path)


def test_an_entry_takes_its_venue_from_the_title_of_the_one_that_it_refers_to(
    tmp_path: Path,
) -> None:
    text = '@inproceedings{a, title = "A", crossref = {p}}\n@proceedings{p, year = 2008%s}\n'
    assert entries(tmp_path, text % ', title = "Proc. X"')["a"] == ("A", "Proc. X")
    assert entries(tmp_path, text % "")["a"] == ("A", "")


def test_items_of_a_bbl_without_a_label_are_read_and_those_without_a_key_left_out(
    tmp_path: Path,
) -> None:
    item = "{a}\n\\bibinfo{title}{A}, \\bibinfo{journal}{J}.\n"
    assert entries(tmp_path, "\\bibitem" + item) == {"a": ("A", "J")}
    assert entries(tmp_path, "\\bibitem[{X(2008)}]" + item + "\\bibitem no key") == {
        "a": ("A", "J")
    }
    for text in ("\\bibitem no key", "\\bibitem[{X(2008) never closed" + item):
        with pytest.raises(SurveyImportError, match=r"refs\.bib holds no entry"):
            entries(tmp_path, text)


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
    assert [match.value for match in ValueReader(tables).read(attribute, text)] == expected


def test_a_parenthesis_of_a_list_belongs_to_the_value_before_it(
    tables: survey_data.SurveyTables,
) -> None:
    with pytest.raises(UnreadableValueError, match=r"'Sundial \(brass, large\)' is no value"):
        ValueReader(tables).read("mask", "Slit, Sundial (brass, large)")


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


@pytest.mark.parametrize(
    "title", ["Fuzzy image processing in sun sensors", "Fuzzy imag processing in sunn sensors"]
)
def test_a_title_of_two_studies_is_not_guessed(title: str, finder: StudyFinder) -> None:
    with pytest.raises(StudyNotFoundError, match="may mean Mobasser2001 or Other2001"):
        finder.find(title=title)


def test_a_study_is_found_by_a_misprinted_title_and_by_a_key_without_a_year(
    finder: StudyFinder,
) -> None:
    assert finder.find(title="A sundial of polish brass") == "Timeless"
    assert finder.find(study="timeless") == "Timeless"
    with pytest.raises(StudyNotFoundError, match="no study by 'Timeless' of 2001"):
        finder.find(authors="Timeless", year="2001")


def test_a_folder_where_no_lock_can_be_made_is_refused(tmp_path: Path) -> None:
    lock_path(tmp_path / "tables").mkdir()
    with (
        pytest.raises(SurveyImportError, match=r"cannot write in .*: Is a directory"),
        locked_tables(tmp_path),
    ):
        pytest.fail("the folder was taken for locked")


def test_an_import_beside_a_damaged_manifest_writes_nothing(copy: Any) -> None:
    (copy.directory / FILE).write_text("{}\n", encoding="utf-8")
    path = copy.directory / "theirs.txt"
    path.write_text("Key;Mask\nAlvi2014;Lens\n", encoding="utf-8")
    before = copy.path("attributes").read_bytes()
    with pytest.raises(SurveyImportError, match=r"checksums-sha256.txt, line 1: expected 64"):
        import_table(path, copy.directory, apply=True)
    assert copy.path("attributes").read_bytes() == before
