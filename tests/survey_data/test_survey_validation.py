"""Every kind of corruption of every table is reported with file, row and column."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import survey_data
from survey_data.descriptor import DATA_DIRECTORY, column_types, file_name, table_names
from survey_data.editions import EXTENSION_TABLES

#: Those of the survey; the tables of those it does not map may be empty (`additions/`).
ALL = tuple(name for name in table_names() if name not in EXTENSION_TABLES)
PRINTED = "study_tables.csv"


def located(problems: list[survey_data.Problem], row: int, column: str | None = None) -> bool:
    """Say whether a problem names this row (and column, if one is given)."""
    return any(
        p.row == row and p.column is not None and (column is None or p.column == column)
        for p in problems
    )


def test_the_shipped_tables_are_valid() -> None:
    assert survey_data.validate() == []


def test_a_plain_copy_is_valid_also_with_windows_line_ends(copy: Any) -> None:
    for table in ALL:
        path = copy.path(table)
        path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    assert survey_data.validate(copy.directory) == []
    assert len(survey_data.load(copy.directory).studies) == 129


def test_a_directory_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(NotADirectoryError, match="nowhere"):
        survey_data.validate(tmp_path / "nowhere")


def line(data: bytes, row: int) -> tuple[list[bytes], int]:
    return data.split(b"\n"), row - 1


def in_line(old: bytes | None, new: bytes, row: int = 3) -> object:
    """Corrupt one line: replace its first `old` (its start where None) by `new`."""

    def corrupt(data: bytes) -> bytes:
        lines, index = line(data, row)
        lines[index] = new + lines[index] if old is None else lines[index].replace(old, new, 1)
        return b"\n".join(lines)

    return corrupt


def without_last_cell(data: bytes) -> bytes:
    lines, index = line(data, 3)
    lines[index] = b"alone"
    return b"\n".join(lines)


def double_first_column(data: bytes) -> bytes:
    lines = data.split(b"\n")
    first, _, *rest = lines[0].split(b",")
    return b"\n".join([b",".join([first, first, *rest]), *lines[1:]])


FORM = {
    "unclosed quote": (in_line(None, b'"'), 3),
    "stray quote": (in_line(b",", b'x"y,'), 3),
    "extra cell": (in_line(None, b"one,more,"), 3),
    "missing cell": (without_last_cell, 3),
    "bad encoding": (in_line(None, b"\xff\xfe"), 3),
    "null byte": (in_line(None, b"\x00"), 3),
    "blank row": (in_line(None, b"\n"), 3),
    "space around a value": (in_line(None, b" "), 3),
    "byte-order mark": (in_line(None, b"\xef\xbb\xbf", row=1), 1),
    "missing column": (in_line(b",", b"_", row=1), 1),
    "renamed column": (in_line(None, b"x", row=1), 1),
    "duplicate column": (double_first_column, 1),
    "empty file": (lambda data: b"", 1),
}


@pytest.mark.parametrize("kind", FORM)
def test_broken_form_is_located_in_every_table(kind: str, copy: Any) -> None:
    from survey_data.table_records import read_records

    corrupt, row = FORM[kind]
    for table in ALL:
        path = copy.path(table)
        path.write_bytes(corrupt(path.read_bytes()))
        problems = read_records(path, list(column_types(table))).problems
        assert located(problems, row), (table, problems)
        assert {p.file for p in problems} == {file_name(table)}


def test_a_missing_file_is_named_and_nothing_else_is_blamed(copy: Any) -> None:
    table = "taxonomy"
    copy.path(table).unlink()
    problems = survey_data.validate(copy.directory)
    assert survey_data.Problem(file_name(table), None, None, "the file is missing") in problems
    assert {p.file for p in problems} == {file_name(table)}
    with pytest.raises(survey_data.SurveyDataError, match=f"{file_name(table)}: the file is miss"):
        survey_data.load(copy.directory)


def test_a_count_that_does_not_hold_is_reported_at_the_end_of_the_table(copy: Any) -> None:
    copy.set("counts", 3, "held", "7")  # the studies of 2001
    problems = survey_data.validate(copy.directory)
    assert [(p.file, p.row, p.column) for p in problems] == [("studies.csv", 131, "year")]
    copy.set("counts", 3, "column", "sundial")
    assert located(copy.found("counts.csv"), 3, "column")


def test_a_value_that_is_of_another_attribute_is_the_fault_of_the_value(copy: Any) -> None:
    """Where a pair refers to another table, its last column is named."""
    assert copy.rows("roles")[1][:2] == ["Antonello2018", "model"]
    copy.set("roles", 2, "value", "CMOS")  # a detector
    assert {p.column for p in copy.found("roles.csv") if p.row == 2} == {"value"}


def test_a_number_is_a_number_in_range(copy: Any) -> None:
    texts = ["0", "200", "-1", "nan", "inf", "0,5", "1e99", "0.5 deg", "\u0663"]
    rows = copy.rows("attributes")
    at = [i for i, cells in enumerate(rows, 1) if cells[1] == "accuracy_deg"]
    for row, text in zip(at, texts, strict=False):
        copy.set("attributes", row, "value", text)
    problems = copy.found("attributes.csv")
    assert [p.row for p in problems] == at[: len(texts)]
    assert {p.column for p in problems} == {"value"}


def test_a_cell_has_one_basis(copy: Any) -> None:
    rows = copy.rows("attributes")
    row = next(i for i, cells in enumerate(rows, 1) if cells[3] == "abstract")
    again = list(rows[row - 1])
    again[3] = "title"
    copy.edit("attributes", lambda rows: rows.append(again))
    problems = copy.found("attributes.csv")
    assert any(p.column == "basis" and "two bases" in p.message for p in problems)


def test_a_study_without_a_row_for_an_attribute_is_named(copy: Any) -> None:
    copy.edit(
        "attributes",
        lambda rows: rows.remove(next(c for c in rows if c[:2] == ["Chang2008", "mask"])),
    )
    row = next(i for i, c in enumerate(copy.rows("studies"), 1) if c[0] == "Chang2008")
    problems = copy.found("studies.csv")
    assert [(p.row, p.column) for p in problems] == [(row, "key")]
    assert "mask" in problems[0].message


def test_a_printed_cell_must_be_carried_and_a_carried_cell_printed(copy: Any) -> None:
    rows = copy.rows("attributes")
    row = next(i for i, c in enumerate(rows, 1) if c[:3] == ["Chang2008", "extractor", "BCTM"])
    copy.set("attributes", row, "value", "PD")
    problems = survey_data.validate(copy.directory)
    assert located([p for p in problems if p.file == "attributes.csv"], row, "value")
    assert any(p.file == "study_tables.csv" and "Chang2008" in p.message for p in problems)


def test_a_kind_of_a_printed_label_agrees_with_it_and_another_label_s_does_not(copy: Any) -> None:
    rows = copy.rows("attributes")
    row = next(i for i, c in enumerate(rows, 1) if c[:3] == ["OKeefe2017", "model", "ECM/Noise"])
    copy.set("attributes", row, "value", "ECM/Angular loss")  # printed as ECM
    assert {p.file for p in survey_data.validate(copy.directory)} == {"roles.csv"}
    copy.set("attributes", row, "value", "ICM/Shadow")
    assert any("OKeefe2017 is printed under 'ECM'" in p.message for p in copy.found(PRINTED))
    # The tables print no kinds: one cannot rest on them.
    copy.set("attributes", row, "value", "ECM/Noise")
    copy.set("attributes", row, "basis", "survey-table")
    assert located(copy.found("attributes.csv"), row, "value")


def test_doi_and_year_syntax_are_checked(copy: Any) -> None:
    dois = ["doi:10.1109/x", "https://doi.org/10.1109/x", "11.1109/x", "10.1109/", "10.1109/a b"]
    years = ["1999", "14", "20l4", "2014.5", "03000"]
    for row, (doi, year) in enumerate(zip(dois, years, strict=True), 2):
        copy.set("studies", row, "doi", doi)
        copy.set("studies", row, "year", year)
    problems = copy.found("studies.csv")
    for row in range(2, 2 + len(dois)):
        assert located(problems, row, "doi")
        assert located(problems, row, "year") or row == 2
    # only where every year can be read is it compared with the key's
    for row, key_year in enumerate(["2014", "2011", "2009", "2014", "2018"], 2):
        copy.set("studies", row, "year", key_year)
    copy.set("studies", 2, "year", "2015")
    assert located(copy.found("studies.csv"), 2, "year")


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "not JSON"),
        (b"{", "not JSON"),
        (b"\xff", "not UTF-8 text"),
        (b"[]", "differs from the descriptor"),
        (b"[" * 100_000, "not JSON"),
    ],
)
def test_a_broken_descriptor_is_reported(content: bytes, expected: str, tmp_path: Path) -> None:
    (tmp_path / "datapackage.json").write_bytes(content)
    problems = survey_data.validate(tmp_path)
    assert any(p.file == "datapackage.json" and expected in p.message for p in problems)
    assert len(problems) == 1 + len(table_names())  # there are no tables beside it


def test_a_weakened_descriptor_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "datapackage.json"
    text = (DATA_DIRECTORY / path.name).read_text(encoding="utf-8")
    path.write_text(text.replace('"required": true', '"required": 1', 1), encoding="utf-8")
    found = [p.message for p in survey_data.validate(tmp_path) if p.file == path.name]
    assert found == ["differs from the descriptor in use"]
    path.unlink()
    assert survey_data.Problem(path.name, None, None, "the file is missing") in (
        survey_data.validate(tmp_path)
    )
