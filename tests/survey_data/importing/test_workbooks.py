"""A workbook beyond a limit is refused with the limit; values are spelt as a person sees them."""

from __future__ import annotations

import datetime as dt
import io
import zipfile
from collections.abc import Mapping
from pathlib import Path

import openpyxl
import pytest

from survey_data import SurveyImportError, read_table
from survey_data.importing.table_reader import LONGEST_CELL

SHEET = "xl/worksheets/sheet1.xml"


def saved(*rows: list[object]) -> dict[str, bytes]:
    """Return the files of a small workbook."""
    book = openpyxl.Workbook()
    for row in rows:
        book.worksheets[0].append(row)
    stream = io.BytesIO()
    book.save(stream)
    with zipfile.ZipFile(stream) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.fixture(scope="module")
def parts() -> dict[str, bytes]:
    return saved(["Key", "Year"], ["Chang2008", 2008])


def packed(folder: Path, parts: Mapping[str, bytes], rows: bytes = b"", start: bytes = b"") -> Path:
    """Return a workbook with rows behind its own, and a start of its sheet."""
    sheet = parts[SHEET].replace(b"</sheetData>", rows + b"</sheetData>")
    path = folder / "theirs.xlsx"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in {**parts, SHEET: start + sheet}.items():
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
