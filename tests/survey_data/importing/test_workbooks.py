"""Workbooks: refused beyond a limit or where they mislead, values as a person sees them."""

from __future__ import annotations

import datetime as dt
import io
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from survey_data import SurveyImportError, read_table
from survey_data.importing.table_reader import LONGEST_CELL

SHEET = "xl/worksheets/sheet1.xml"


def saved(*rows: list[object], change: Callable[[Any], None] | None = None) -> dict[str, bytes]:
    """Return the files of a small workbook, with something changed before it is saved."""
    book = openpyxl.Workbook()
    for row in rows:
        book.worksheets[0].append(row)
    if change is not None:
        change(book)
    stream = io.BytesIO()
    book.save(stream)
    with zipfile.ZipFile(stream) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.fixture(scope="module")
def parts() -> dict[str, bytes]:
    return saved(["Key", "Year"], ["Chang2008", 2008])


def packed(folder: Path, parts: Mapping[str, bytes], rows: bytes = b"", end: bytes = b"") -> Path:
    """Return a workbook with rows behind its own, and something behind them."""
    sheet = parts[SHEET].replace(b"</sheetData>", rows + b"</sheetData>" + end)
    path = folder / "theirs.xlsx"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in {**parts, SHEET: sheet}.items():
            archive.writestr(name, data)
    return path


def refusal(path: Path) -> str:
    with pytest.raises(SurveyImportError) as refused:
        read_table(path)
    assert "\n" not in str(refused.value)
    return str(refused.value)


CELL = b'<row r="%d"><c r="%b%d"><v>1</v></c></row>'


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (CELL % (10**9, b"A", 10**9), "has more than 1048576 rows"),
        (CELL % (9, b"ZZZZ", 9), "is not a readable XLSX workbook"),
        (b'<row r="9"><c r="A9" t="s"><v>99</v></c></row>', "is not a readable XLSX workbook"),
        (b'<row r="9">' + b"<c/>" * 300_001 + b"</row>", "has more than 300000 cells"),
        (b"".join(b'<row r="%d"><c r="XFD%d"/></row>' % (n, n) for n in range(5, 50)), "300000 c"),
        (b" " * 20_000_000, "unpacks to more than 20000000 bytes"),
    ],
)
def test_hostile_rows_are_refused(
    rows: bytes, said: str, parts: Mapping[str, bytes], tmp_path: Path
) -> None:
    assert said in refusal(packed(tmp_path, parts, rows))


def test_a_workbook_of_thousands_of_parts_is_refused_unread(
    parts: Mapping[str, bytes], tmp_path: Path
) -> None:
    """Each sheet takes a millisecond, and thousands fit in a file that unpacks to little."""
    many = {f"xl/worksheets/sheet{number}.xml": parts[SHEET] for number in range(2, 1002)}
    assert "has more than 1000 parts, such as sheets" in refusal(
        packed(tmp_path, {**parts, **many})
    )


def test_a_cell_longer_than_excel_s_own_limit_is_named(
    parts: Mapping[str, bytes], tmp_path: Path
) -> None:
    cell = b'<row r="3"><c r="B3" t="inlineStr"><is><t>%b</t></is></c></row>'
    said = refusal(packed(tmp_path, parts, cell % (b"x" * (LONGEST_CELL + 1))))
    assert f"cell B3: longer than {LONGEST_CELL} characters" in said
    frame = read_table(packed(tmp_path, parts, cell % (b"x" * LONGEST_CELL)))
    assert len(frame.at[3, "Year"]) == LONGEST_CELL


@pytest.mark.parametrize(
    ("value", "text"),
    [
        *((2005.0, "2005"), (-3.0, "-3"), (1e20, "1e+20"), (0.05, "0.05")),
        (dt.datetime.fromisoformat("2008-05-01"), "2008-05-01"),
        (dt.datetime.fromisoformat("2008-05-01T12:30"), "2008-05-01T12:30:00"),
        ("a_x000D_\nb", "a\r\nb"),
    ],
)
def test_a_value_is_spelt_as_a_person_sees_it(value: object, text: str, tmp_path: Path) -> None:
    path = packed(tmp_path, saved(["Key", "Said"], ["Chang2008", value]))
    assert read_table(path).at[2, "Said"] == text


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("#N/A", "cell B2: an error (#N/A)"),
        (True, "cell B2: a truth value"),
        ("a\ufffd", "U+FFFD"),
        ("=0.1*5", "cell B2: a formula without a value"),
    ],
)
def test_what_is_no_value_is_named_by_its_cell(value: object, said: str, tmp_path: Path) -> None:
    assert said in refusal(packed(tmp_path, saved(["Key", "Said"], ["Alvi2014", value])))


def test_a_stray_cell_at_the_far_corner_is_refused(tmp_path: Path) -> None:
    def far(book: Any) -> None:
        book.active["XFD1048576"] = "x"

    path = packed(tmp_path, saved(["Key", "Mask"], ["Alvi2014", "Slit"], change=far))
    assert "row 1048576, column Mask: 16384 cells" in refusal(path)


def test_empty_formatted_cells_and_merges_to_the_last_row_are_passed_over(tmp_path: Path) -> None:
    def far(book: Any) -> None:
        book.active["XFD2000"].number_format = "0"

    merged = b'<mergeCells count="1"><mergeCell ref="D5:XFD1048576"/></mergeCells>'
    parts = saved(["Key", "Mask"], ["Alvi2014", "Slit"], change=far)
    assert read_table(packed(tmp_path, parts, end=merged)).shape == (1, 2)


def test_a_hidden_sheet_is_read_only_where_it_is_named(tmp_path: Path) -> None:
    def hide(book: Any) -> None:
        book.active.sheet_state = "hidden"
        book.create_sheet("seen")

    def fill(book: Any) -> None:
        hide(book)
        for row in (["Key", "Mask"], ["Bao2020", "Slit"]):
            book["seen"].append(row)

    rows: list[list[object]] = [["Key", "Mask"], ["Alvi2014", "Slit"]]
    assert "hidden sheets alone (Sheet)" in refusal(packed(tmp_path, saved(*rows, change=hide)))
    path = packed(tmp_path, saved(*rows, change=fill))
    assert list(read_table(path)["Key"]) == ["Bao2020"]
    assert list(read_table(path, "Sheet")["Key"]) == ["Alvi2014"]
