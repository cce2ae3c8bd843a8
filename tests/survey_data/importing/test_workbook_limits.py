"""A workbook beyond a limit is refused with the limit; values are spelt as a person sees them."""

from __future__ import annotations

import datetime as dt
import io
import itertools
import warnings
import zipfile
from collections.abc import Mapping

import openpyxl
import pytest

from survey_data import SurveyImportError
from survey_data.importing import workbooks
from survey_data.importing.workbooks import LONGEST_CELL, read_workbook

SHEET = "xl/worksheets/sheet1.xml"


@pytest.fixture(scope="module")
def parts() -> dict[str, bytes]:
    """Return the files of a small workbook: a header and one row."""
    book = openpyxl.Workbook()
    for row in (["Key", "Year"], ["Chang2008", 2008]):
        book.worksheets[0].append(row)
    stream = io.BytesIO()
    book.save(stream)
    with zipfile.ZipFile(stream) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def packed(parts: Mapping[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    return stream.getvalue()


def with_rows(parts: Mapping[str, bytes], rows: str) -> bytes:
    """Return the workbook with these rows behind its own."""
    sheet = parts[SHEET]
    assert b"</sheetData>" in sheet
    return packed({**parts, SHEET: sheet.replace(b"</sheetData>", rows.encode() + b"</sheetData>")})


def refusal(data: bytes) -> SurveyImportError:
    with pytest.raises(SurveyImportError) as refused:
        read_workbook("theirs.xlsx", data, None)
    return refused.value


def test_the_workbook_that_the_limits_are_tried_on_is_read(parts: Mapping[str, bytes]) -> None:
    assert read_workbook("theirs.xlsx", packed(parts), None) == [
        (1, ["Key", "Year"]),
        (2, ["Chang2008", "2008"]),
    ]


def test_an_archive_of_too_many_files_is_refused(parts: Mapping[str, bytes]) -> None:
    more = {f"xl/{at}.xml": b"" for at in range(2001)}
    assert "holds more than 2000 files" in str(refusal(packed({**parts, **more})))


def test_two_files_of_one_name_are_refused(parts: Mapping[str, bytes]) -> None:
    stream = io.BytesIO(packed(parts))
    with zipfile.ZipFile(stream, "a") as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # zipfile's own, of the name that stands twice
        archive.writestr(SHEET, parts[SHEET])
    assert "holds two files of one name" in str(refusal(stream.getvalue()))


def test_entities_of_xml_are_refused_with_the_part_that_defines_them(
    parts: Mapping[str, bytes],
) -> None:
    start = b'<!DOCTYPE x [<!ENTITY a "aa">]>'
    said = str(refusal(packed({**parts, SHEET: start + parts[SHEET]})))
    assert f"{SHEET} defines entities of XML" in said


@pytest.mark.parametrize(
    ("limit", "most", "said"),
    [
        ("LARGEST_BYTES", 100, "theirs.xlsx unpacks to more than 100 bytes"),
        ("_MOST_TAGS", 5, "has more than 5 tags"),
        ("_LARGEST_HELD", 300, "xl/styles.xml unpacks to more than 300 bytes"),
        ("LARGEST_CELLS", 3, "theirs.xlsx has more than 3 cells"),
        ("LARGEST_ROWS", 1, "theirs.xlsx has more than 1 rows"),
    ],
)
def test_a_workbook_beyond_a_limit_is_refused_with_the_limit(
    limit: str, most: int, said: str, parts: Mapping[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    held = {name: data for name, data in parts.items() if "styles" in name} | dict(parts)
    monkeypatch.setattr(workbooks, limit, most)
    assert said in str(refusal(packed(held)))


def test_the_size_of_a_sheet_is_not_limited_as_that_of_parts_that_are_held(
    parts: Mapping[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    longest = max(len(data) for name, data in parts.items() if name != SHEET)
    rows = "".join(
        f'<row r="{at}"><c r="A{at}"><v>{at}</v></c></row>' for at in range(3, longest // 30)
    )
    data = with_rows(parts, rows)
    monkeypatch.setattr(workbooks, "_LARGEST_HELD", longest)
    assert len(rows) > longest
    assert len(read_workbook("theirs.xlsx", data, None)) == longest // 30 - 1


def test_a_workbook_that_takes_too_long_is_refused(
    parts: Mapping[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = itertools.count(0.0, workbooks.LONGEST_SECONDS + 1.0)
    monkeypatch.setattr("time.monotonic", lambda: next(clock))
    assert "takes longer than 8 s to read" in str(refusal(packed(parts)))


@pytest.mark.parametrize("number", [2, 1])
def test_a_row_that_stands_twice_or_out_of_order_is_refused(
    number: int, parts: Mapping[str, bytes]
) -> None:
    error = refusal(with_rows(parts, f'<row r="{number}"><c r="A{number}"><v>1</v></c></row>'))
    assert error.row == number
    assert f"row {number} stands twice or out of order" in str(error)


def test_a_cell_longer_than_excel_s_own_limit_is_named(parts: Mapping[str, bytes]) -> None:
    cell = '<row r="3"><c r="AB3" t="inlineStr"><is><t>{}</t></is></c></row>'
    error = refusal(with_rows(parts, cell.format("x" * (LONGEST_CELL + 1))))
    assert f"cell AB3: longer than {LONGEST_CELL} characters" in str(error)
    assert error.row == 3
    *_, (_, cells) = read_workbook(
        "theirs.xlsx", with_rows(parts, cell.format("x" * LONGEST_CELL)), None
    )
    assert len(cells[27]) == LONGEST_CELL


@pytest.mark.parametrize(
    ("number", "text"), [("2005.0", "2005"), ("-3.0", "-3"), ("1e20", "1e+20"), ("0.05", "0.05")]
)
def test_a_number_is_spelt_as_a_whole_one_where_it_is_one(
    number: str, text: str, parts: Mapping[str, bytes]
) -> None:
    data = with_rows(parts, f'<row r="3"><c r="A3"><v>{number}</v></c></row>')
    assert read_workbook("theirs.xlsx", data, None)[-1] == (3, [text, ""])


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (dt.datetime.fromisoformat("2008-05-01"), "2008-05-01"),
        (dt.datetime.fromisoformat("2008-05-01T12:30"), "2008-05-01T12:30:00"),
        ("a_x000D_\nb", "a\r\nb"),
    ],
)
def test_a_day_is_spelt_without_an_hour_and_a_line_break_is_kept(value: object, text: str) -> None:
    book = openpyxl.Workbook()
    book.worksheets[0].append(["Date"])
    book.worksheets[0].append([value])
    stream = io.BytesIO()
    book.save(stream)
    assert read_workbook("theirs.xlsx", stream.getvalue(), None)[1] == (2, [text])
