"""Reading a table somebody else made: CSV with any usual delimiter, or XLSX."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from files.reading import FileRefusedError, read_bytes
from survey_data.importing.workbooks import LARGEST_CELLS, LARGEST_ROWS, Row, read_workbook
from survey_data.problems import SurveyImportError

_DELIMITERS = (",", ";", "\t", "|")
_ZIP_MAGIC = b"PK\x03\x04"
_OLD_EXCEL_MAGIC = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_WORKBOOK_SUFFIXES = {".xlsx", ".xlsm"}
_LARGEST_BYTES = 30_000_000
_LONGEST_LINE = 1_000_000
#: What a spreadsheet writes where a formula fails; read as text it would pass for "not stated".
_ERRORS = frozenset({"#N/A", "#VALUE!", "#REF!", "#DIV/0!", "#NAME?", "#NUM!", "#NULL!"})


def read_table(path: str | Path, sheet: str | None = None) -> pd.DataFrame:
    """Read a CSV or XLSX table as text.

    The first row that is not blank is the header. CSV: UTF-8 (with or without byte-order mark) or
    UTF-16 with one; comma, semicolon, tab or bar, whichever cuts the header into most columns.

    Parameters
    ----------
    path : str or Path
        The file. XLSX is recognised by its content and its suffix, which must agree.
    sheet : str, optional
        Sheet of the workbook; by default the first that is not empty.

    Returns
    -------
    pandas.DataFrame
        Cells as str without surrounding space, empty ones missing; the index (``row``) is the row
        number in the file, the first line being 1. Blank rows are left out.

    Raises
    ------
    SurveyImportError
        The file cannot be read as a table: names row and column where there is one.
    """
    path = Path(path)
    try:
        data = read_bytes(path, _LARGEST_BYTES)
    except FileNotFoundError as error:
        raise SurveyImportError(f"cannot read {path}: {error.strerror}") from error
    except FileRefusedError as error:
        raise SurveyImportError(f"cannot read {path}: {error.reason}") from error
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
        rows = read_workbook(path.name, data, sheet)
    elif sheet is not None:
        raise SurveyImportError(f"{path.name} is no workbook and has no sheet {sheet!r}")
    else:
        rows = _read_text(_decode(path.name, data))
    return _as_frame(path.name, rows)


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
    delimiter = max(_DELIMITERS, key=lambda mark: _columns(header, mark))
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    rows: list[Row] = []
    start = 1
    count = 0
    try:
        for cells in reader:
            count += len(cells)
            if count > LARGEST_CELLS:
                raise SurveyImportError(f"more than {LARGEST_CELLS} cells", row=start)
            rows.append((start, cells))
            start = reader.line_num + 1
    except csv.Error as error:
        raise SurveyImportError(f"broken CSV: {error}", row=start) from error
    return rows


def _columns(header: str, delimiter: str) -> int:
    try:
        return len(next(csv.reader([header], delimiter=delimiter)))
    except csv.Error:  # a field beyond the limit, which reading the rows names
        return 0


def _require_words(rows: Sequence[Row], header: list[str]) -> None:
    """Refuse cells that state that something went wrong where the table was made."""
    for number, cells in rows:
        for place, cell in enumerate(cells):
            column = header[place] if place < len(header) else None
            if "\ufffd" in cell:
                said = f"{cell[:80]!r} holds U+FFFD, a letter that was lost"
                raise SurveyImportError(said, row=number, column=column)
            if cell in _ERRORS:
                said = f"{cell} is an error of a spreadsheet and no value"
                raise SurveyImportError(said, row=number, column=column)


def _as_frame(name: str, rows: Sequence[Row]) -> pd.DataFrame:
    filled = [(number, [cell.strip() for cell in cells]) for number, cells in rows]
    filled = [(number, cells) for number, cells in filled if any(cells)]
    if not filled:
        raise SurveyImportError(f"{name} is empty; expected a header and rows", row=1)
    if len(filled) > LARGEST_ROWS:
        raise SurveyImportError(f"{name} has more than {LARGEST_ROWS} rows")
    (header_row, header), *body = filled
    while header and not header[-1]:
        header.pop()
    _check_header(header, header_row)
    _require_words(filled, header)
    if not body:
        raise SurveyImportError(f"{name} has a header and no rows", row=header_row + 1)
    for number, cells in body:
        if any(cells[len(header) :]):
            raise SurveyImportError(
                f"{len(cells)} cells, but the header has {len(header)} columns",
                row=number,
                column=header[-1],
            )
        if len(cells) < len(header):
            raise SurveyImportError(
                f"the row ends after {len(cells)} of {len(header)} cells",
                row=number,
                column=header[len(cells)],
            )
    return pd.DataFrame(
        [[cell or None for cell in cells[: len(header)]] for _, cells in body],
        columns=pd.Index(header, dtype="str"),
        index=pd.Index([number for number, _ in body], name="row"),
        dtype="str",
    )


def _check_header(header: list[str], row: int) -> None:
    seen: dict[str, str] = {}
    for position, column in enumerate(header, 1):
        if not column:
            raise SurveyImportError(f"column {position} has no name", row=row)
        other = seen.setdefault(column.casefold(), column)
        if list(seen).index(column.casefold()) != position - 1:
            raise SurveyImportError(
                f"the column stands twice (also as {other!r})", row=row, column=column
            )
