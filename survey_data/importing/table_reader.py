"""Reading a table somebody else made: CSV with any usual delimiter, or XLSX.

Limits on bytes, rows and cells hold whatever a workbook says of its own size.
"""

from __future__ import annotations

import csv
import datetime as dt
import io
import warnings
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from survey_data.importing.writing import offered_bytes
from survey_data.problems import SurveyImportError

#: What the parts of a workbook may unpack to, together.
LARGEST_UNPACKED = 20_000_000
#: Parts of a workbook, of which each sheet is one: a millisecond each.
_MOST_PARTS = 1000
LARGEST_ROWS = 20_000
LARGEST_CELLS = 300_000
LONGEST_CELL = 32_767  # Excel's own limit
_LAST_ROW = 1_048_576  # as above
_LARGEST_BYTES = 30_000_000
_LONGEST_LINE = 1_000_000
_DELIMITERS = (",", ";", "\t", "|")
_ZIP_MAGIC = b"PK\x03\x04"
_OLD_EXCEL_MAGIC = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_WORKBOOK_SUFFIXES = {".xlsx", ".xlsm"}
#: What a spreadsheet writes where a formula fails; read as text it would pass for "not stated".
_ERRORS = frozenset({"#N/A", "#VALUE!", "#REF!", "#DIV/0!", "#NAME?", "#NUM!", "#NULL!"})

Row = tuple[int, list[str]]


def read_table(path: str | Path, sheet: str | None = None) -> pd.DataFrame:
    """Read a CSV or XLSX table as text, empty cells missing.

    The first row that is not blank is the header; the index (``row``) is the row number in the
    file, the first line being 1. CSV: UTF-8, or UTF-16 with a byte-order mark; comma, semicolon,
    tab or bar, whichever cuts the header into most columns. XLSX is known by its content and its
    suffix, which must agree; without `sheet` the first visible sheet that is not empty is read.

    Raises
    ------
    SurveyImportError
        The file cannot be read as a table, or is larger than the limits of this module: names row
        and column where there is one.
    """
    path = Path(path)
    data = offered_bytes(path, _LARGEST_BYTES)
    if not data.strip():
        raise SurveyImportError(f"{path.name} is empty; expected a header and rows", row=1)
    named_workbook = path.suffix.lower() in _WORKBOOK_SUFFIXES
    if data.startswith(_OLD_EXCEL_MAGIC):
        raise SurveyImportError(f"{path.name} is an old Excel file; save it as .xlsx or CSV")
    if named_workbook != data.startswith(_ZIP_MAGIC):
        raise SurveyImportError(
            f"{path.name} is named as a workbook but is not one"
            if named_workbook
            else f"{path.name} is a zip archive or workbook, not CSV; a workbook ends in .xlsx"
        )
    if named_workbook:
        return _as_frame(path.name, _read_workbook(path.name, data, sheet))
    if sheet is not None:
        raise SurveyImportError(f"{path.name} is no workbook and has no sheet {sheet!r}")
    return _as_frame(path.name, _read_text(_decode(path.name, data)))


def _read_workbook(name: str, data: bytes, wanted: str | None) -> list[Row]:
    from openpyxl import load_workbook  # noqa: PLC0415 - most calls read CSV

    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive, warnings.catch_warnings():
            _require_size(name, archive)
            warnings.simplefilter("ignore")  # of styles and validations that it drops
            values = load_workbook(io.BytesIO(data), read_only=True, data_only=True)
            formulas = load_workbook(io.BytesIO(data), read_only=True)
            rows = _rows_of_sheet(name, values, formulas, wanted)
    except SurveyImportError:
        raise
    except Exception as error:  # a mangled part leads openpyxl to raise anything
        said = " ".join(str(error).split())[:200]
        raise SurveyImportError(f"{name} is not a readable XLSX workbook: {said}") from error
    width = len(rows[0][1]) if rows else 0  # a row ends with its last filled cell
    return [(number, cells + [""] * (width - len(cells))) for number, cells in rows]


def _require_size(name: str, archive: zipfile.ZipFile) -> None:
    """Refuse an archive that unpacks to too much; zipfile unpacks no more than the stated size."""
    if len(archive.infolist()) > _MOST_PARTS:
        raise SurveyImportError(f"{name} has more than {_MOST_PARTS} parts, such as sheets")
    if sum(member.file_size for member in archive.infolist()) > LARGEST_UNPACKED:
        raise SurveyImportError(f"{name} unpacks to more than {LARGEST_UNPACKED} bytes")


def _rows_of_sheet(name: str, values: Any, formulas: Any, wanted: str | None) -> list[Row]:
    """Return the rows of the sheet that is wanted, or of the first visible one with rows."""
    titles = [sheet.title for sheet in values.worksheets]
    if wanted is not None:
        if wanted not in titles:
            raise SurveyImportError(f"{name} has no sheet {wanted!r}; it has {', '.join(titles)}")
        return list(_filled_rows(name, values[wanted], formulas[wanted]))
    for title in titles:
        if values[title].sheet_state == "visible":
            rows = list(_filled_rows(name, values[title], formulas[title]))
            if rows:
                return rows
    hidden = [title for title in titles if values[title].sheet_state != "visible"]
    if any(list(_filled_rows(name, values[title], formulas[title])) for title in hidden):
        said = ", ".join(hidden)
        raise SurveyImportError(
            f"{name} has rows in hidden sheets alone ({said}); name one with --sheet"
        )
    return []


def _filled_rows(name: str, sheet: Any, formulas: Any) -> Iterator[Row]:
    """Give the rows of a sheet that hold anything, without the cells behind the last filled one."""
    sheet.reset_dimensions()
    formulas.reset_dimensions()
    count = filled = 0
    for number, (row, written) in enumerate(zip(sheet.rows, formulas.rows, strict=True), 1):
        if not row and number <= _LAST_ROW:  # of a million before a cell far down
            continue
        texts = [
            _text(f"sheet {sheet.title}", cell, formula)
            for cell, formula in zip(row, written, strict=True)
        ]
        while texts and not texts[-1]:
            texts.pop()
        count += len(row)
        filled += bool(texts)
        limits = ((count, LARGEST_CELLS, "cells"), (filled, LARGEST_ROWS, "rows"))
        for found, most, what in (*limits, (number, _LAST_ROW, "rows")):
            if found > most:
                raise SurveyImportError(f"{name} has more than {most} {what}")
        if texts:
            yield number, texts


def _text(sheet: str, cell: Any, written: Any) -> str:
    """Spell a cell, with what is written in it; one without a value is empty."""
    value = cell.value
    text = "" if value is None else str(value).replace("_x000D_", "\r")
    wrong = ""
    if value is None and written.data_type == "f" and cell.data_type != "str":
        wrong = "a formula without a value; let the program that made it compute, and save it"
    elif cell.data_type == "e":
        wrong = f"an error ({text}) is no value of a table"
    elif isinstance(value, bool):
        wrong = f"a truth value ({text}) is no value of a table"
    elif len(text) > LONGEST_CELL:
        wrong = f"longer than {LONGEST_CELL} characters"
    if wrong:
        raise SurveyImportError(f"{sheet}, cell {cell.coordinate}: {wrong}", row=cell.row)
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    if isinstance(value, dt.datetime):
        return value.date().isoformat() if value.time() == dt.time() else value.isoformat()
    return text


def _decode(name: str, data: bytes) -> str:
    encoding = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        row = data[: error.start].count(b"\n") + 1
        raise SurveyImportError(
            f"{name} is not {encoding.removesuffix('-sig').upper()} text "
            f"(byte 0x{data[error.start]:02x}); save it as CSV UTF-8",
            row=row,
        ) from error
    if "\x00" in text:
        row = text[: text.index("\x00")].count("\n") + 1
        raise SurveyImportError(f"{name} is not a text file: it holds a null character", row=row)
    return text


def _read_text(text: str) -> list[Row]:
    header = next((line for line in text.splitlines() if line.strip()), "")
    if len(header) > _LONGEST_LINE:
        raise SurveyImportError(f"the header is longer than {_LONGEST_LINE} characters", row=1)
    rows: list[Row] = []
    start = 1
    count = 0
    try:
        delimiter = max(
            _DELIMITERS, key=lambda mark: len(next(csv.reader([header], delimiter=mark)))
        )
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
        for cells in reader:
            count += len(cells)
            if count > LARGEST_CELLS:
                raise SurveyImportError(f"more than {LARGEST_CELLS} cells", row=start)
            rows.append((start, cells))
            start = reader.line_num + 1
    except csv.Error as error:
        raise SurveyImportError(f"broken CSV: {error}", row=start) from error
    return rows


def _as_frame(name: str, rows: Sequence[Row]) -> pd.DataFrame:
    filled = [(number, [cell.strip() for cell in cells]) for number, cells in rows]
    filled = [(number, cells) for number, cells in filled if any(cells)]
    if not filled:
        raise SurveyImportError(f"{name} is empty; expected a header and rows", row=1)
    if len(filled) > LARGEST_ROWS:
        raise SurveyImportError(f"{name} has more than {LARGEST_ROWS} rows")
    (header_row, header), *body = filled
    while not header[-1]:
        header.pop()
    seen: dict[str, str] = {}
    for position, column in enumerate(header, 1):
        if not column:
            raise SurveyImportError(f"column {position} has no name", row=header_row)
        if other := seen.get(column.casefold()):
            message = f"the column stands twice (also as {other!r})"
            raise SurveyImportError(message, row=header_row, column=column)
        seen[column.casefold()] = column
    for number, cells in filled:
        _check_cells(number, cells, header)
    if not body:
        raise SurveyImportError(f"{name} has a header and no rows", row=header_row + 1)
    return pd.DataFrame(
        [[cell or None for cell in cells[: len(header)]] for _, cells in body],
        columns=pd.Index(header, dtype="str"),
        index=pd.Index([number for number, _ in body], name="row"),
        dtype="str",
    )


def _check_cells(number: int, cells: Sequence[str], header: Sequence[str]) -> None:
    """Refuse a row of another length, and cells that say that something went wrong before."""
    said = ""
    for place, cell in enumerate(cells):
        if "\ufffd" in cell:
            said = f"{cell[:80]!r} holds U+FFFD, a letter that was lost"
        elif cell in _ERRORS:
            said = f"{cell} is an error of a spreadsheet and no value"
        elif cell and place >= len(header):
            said = f"{len(cells)} cells, but the header has {len(header)} columns"
        if said:
            column = header[min(place, len(header) - 1)]
            raise SurveyImportError(said, row=number, column=column)
    if len(cells) < len(header):
        said = f"the row ends after {len(cells)} of {len(header)} cells"
        raise SurveyImportError(said, row=number, column=header[len(cells)])
