"""Tables in any usual form are read alike; files that are no table are refused with a place."""

from __future__ import annotations

from pathlib import Path

import openpyxl
import pytest

from survey_data import SurveyImportError, read_table

ROWS = [["Key", "Mask", "Year"], ["Chang2008", "Pinhole", "2008"], ["He2005", "", "2005"]]


def text(delimiter: str, end: str = "\n") -> str:
    return end.join(delimiter.join(row) for row in ROWS) + end


def workbook(path: Path, rows: list[list[object]], sheets: int = 1) -> Path:
    book = openpyxl.Workbook()
    for _ in range(sheets - 1):
        book.create_sheet()
    for row in rows:
        book.worksheets[-1].append(row)
    book.save(path)
    return path


@pytest.mark.parametrize(
    "content",
    [
        text(",").encode(),
        text(";").encode(),
        text("\t").encode(),
        text("|").encode(),
        text(",", "\r\n").encode(),
        text(";").encode("utf-8-sig"),
        text("\t").encode("utf-16"),
        text(",").rstrip("\n").encode(),
        b"\n\n" + text(",").encode() + b"\n,,\n",
        text(",").replace("Pinhole", ' "Pinhole" '.strip()).encode(),
        text(",").replace("Pinhole", "  Pinhole ").encode(),
    ],
)
def test_the_usual_forms_of_csv_are_read_alike(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "theirs.csv"
    path.write_bytes(content)
    frame = read_table(path)
    assert list(frame.columns) == ROWS[0]
    assert frame["Key"].tolist() == ["Chang2008", "He2005"]
    assert frame["Year"].tolist() == ["2008", "2005"]
    assert frame["Mask"].isna().tolist() == [False, True]
    assert frame["Mask"].iloc[0] == "Pinhole"


def test_a_workbook_is_read_as_text_from_its_first_filled_sheet(tmp_path: Path) -> None:
    rows: list[list[object]] = [["Key", "Year", "Accuracy"], ["Chang2008", 2008, 0.05]]
    path = workbook(tmp_path / "theirs.xlsx", [*rows, [None, None, None], ["He2005", 2005.0]], 2)
    frame = read_table(path)
    assert frame.index.tolist() == [2, 4]
    assert frame["Year"].tolist() == ["2008", "2005"]
    assert frame["Accuracy"].iloc[0] == "0.05"
    assert read_table(path, sheet="Sheet1").equals(frame)
    with pytest.raises(SurveyImportError, match=r"'Data'.*Sheet1"):
        read_table(path, sheet="Data")


def test_rows_are_numbered_as_lines_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "theirs.csv"
    path.write_text('Key,Mask\nA2001,"Slit\nLens"\n\nB2002,Slit\n', encoding="utf-8")
    assert read_table(path).index.tolist() == [2, 5]


@pytest.mark.parametrize(
    ("name", "content", "place", "expected"),
    [
        ("a.csv", b"", (1, None), "empty"),
        ("a.csv", b"\n \n", (1, None), "empty"),
        ("a.csv", b"\xef\xbb\xbf\n", (1, None), "empty"),
        ("a.csv", b"Key,Mask\n", (2, None), "no rows"),
        ("a.csv", b"Key,Mask,mask\nA,B,C\n", (1, "mask"), "stands twice"),
        ("a.csv", b"Key,,Mask\nA,B,C\n", (1, None), "column 2 has no name"),
        ("a.csv", b"Key,Mask\nA,B\nA,B,C\n", (3, "Mask"), "3 cells"),
        ("a.csv", b"Key,Mask\nA,B\nA\n", (3, "Mask"), "ends after 1 of 2"),
        ("a.csv", b'Key,Mask\nA,B\nA,"B\n', (3, None), "broken CSV"),
        ("a.csv", b'Key,Mask\nA,"B"x\n', (2, None), "broken CSV"),
        ("a.csv", "Key,Mask\nA,B\nMüller,C\n".encode("latin-1"), (3, None), "UTF-8"),
        ("a.csv", b"Key,Mask\nA,#N/A\n", (2, "Mask"), "an error of a spreadsheet"),
        ("a.csv", b"Key,Mask\nA,\x00\n", (2, None), "null character"),
        ("a.csv", b"PK\x03\x04rest", (None, None), "ends in .xlsx"),
        ("a.xlsx", b"Key,Mask\nA,B\n", (None, None), "not one"),
        ("a.xlsx", b"PK\x03\x04rest", (None, None), "not a readable XLSX"),
        ("a.xlsx", b"", (1, None), "empty"),
        ("a.xls", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1rest", (None, None), "old Excel"),
    ],
)
def test_what_is_no_table_is_refused_with_its_place(
    name: str, content: bytes, place: tuple[int | None, str | None], expected: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(SurveyImportError, match=expected) as caught:
        read_table(path)
    assert (caught.value.row, caught.value.column) == place


def test_a_file_that_is_not_there_or_a_directory_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SurveyImportError, match="cannot read"):
        read_table(tmp_path / "nothing.csv")
    with pytest.raises(SurveyImportError, match="cannot read"):
        read_table(tmp_path)


def test_a_sheet_of_a_csv_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "theirs.csv"
    path.write_text(text(","), encoding="utf-8")
    with pytest.raises(SurveyImportError, match="no workbook"):
        read_table(path, sheet="Sheet")
