"""Reading a table somebody else made: CSV with any usual delimiter, or XLSX."""

from __future__ import annotations

import csv
import datetime as dt
import io
import struct
import warnings
import zipfile
import zlib
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from survey_data.problems import SurveyImportError

_DELIMITERS = (",", ";", "\t", "|")
_ZIP_MAGIC = b"PK\x03\x04"
_OLD_EXCEL_MAGIC = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_WORKBOOK_SUFFIXES = {".xlsx", ".xlsm"}
_LARGEST_BYTES = 200_000_000
_LARGEST_ROWS = 100_000

Row = tuple[int, list[str]]


def read_table(path: str | Path, sheet: str | None = None) -> pd.DataFrame:
    """Read a CSV or XLSX table as text.

    The first row that is not blank is the header. CSV: UTF-8 (with or without byte-order mark) or
    UTF-16 with one; comma, semicolon, tab or bar, whichever cuts the header into most columns.

    Parameters
    ----------
    path : str or Path
        The file. XLSX is told by its content and its suffix, which must agree.
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
        if path.stat().st_size > _LARGEST_BYTES:
            raise SurveyImportError(f"{path.name} is larger than {_LARGEST_BYTES} bytes")
        data = path.read_bytes()
    except OSError as error:
        raise SurveyImportError(f"cannot read {path}: {error.strerror or error}") from error
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
        rows = _read_workbook(path.name, data, sheet)
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
    delimiter = max(_DELIMITERS, key=lambda mark: len(next(csv.reader([header], delimiter=mark))))
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    rows: list[Row] = []
    start = 1
    try:
        for cells in reader:
            rows.append((start, cells))
            start = reader.line_num + 1
    except csv.Error as error:
        raise SurveyImportError(f"broken CSV: {error}", row=start) from error
    return rows


def _read_workbook(name: str, data: bytes, sheet: str | None) -> list[Row]:
    # openpyxl raises whatever a mangled part of the archive leads it to.
    mangled = (
        zipfile.BadZipFile,
        zlib.error,
        struct.error,
        OSError,
        EOFError,
        LookupError,
        ValueError,
        TypeError,
        AttributeError,
        SyntaxError,  # XML parse errors
        NotImplementedError,
        RuntimeError,  # encrypted members
    )
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            unpacked = sum(member.file_size for member in archive.infolist())
        sheets = _read_sheets(data) if unpacked <= _LARGEST_BYTES else None
    except mangled as error:
        raise SurveyImportError(f"{name} is not a readable XLSX workbook: {error}") from error
    if sheets is None:
        raise SurveyImportError(f"{name} unpacks to more than {_LARGEST_BYTES} bytes")
    if sheet is not None:
        if sheet not in sheets:
            raise SurveyImportError(f"{name} has no sheet {sheet!r}; it has {', '.join(sheets)}")
        return sheets[sheet]
    return next((rows for rows in sheets.values() if any(any(cells) for _, cells in rows)), [])


def _read_sheets(data: bytes) -> dict[str, list[Row]]:
    from openpyxl import load_workbook  # noqa: PLC0415 - most calls read CSV and need no openpyxl

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # styles and validations openpyxl drops are of no concern
        workbook = load_workbook(io.BytesIO(data), data_only=True, read_only=False)
    return {
        sheet.title: [
            (number, [_cell_text(cell) for cell in cells])
            for number, cells in enumerate(
                sheet.iter_rows(values_only=True, max_row=min(sheet.max_row, _LARGEST_ROWS + 1)), 1
            )
        ]
        for sheet in workbook.worksheets
    }


def _cell_text(cell: object) -> str:
    if cell is None:
        return ""
    if isinstance(cell, float) and cell.is_integer():
        return str(int(cell))
    if isinstance(cell, dt.datetime):
        return cell.date().isoformat() if cell.time() == dt.time() else cell.isoformat()
    return str(cell)


def _as_frame(name: str, rows: Sequence[Row]) -> pd.DataFrame:
    filled = [(number, [cell.strip() for cell in cells]) for number, cells in rows]
    filled = [(number, cells) for number, cells in filled if any(cells)]
    if not filled:
        raise SurveyImportError(f"{name} is empty; expected a header and rows", row=1)
    if len(filled) > _LARGEST_ROWS:
        raise SurveyImportError(f"{name} has more than {_LARGEST_ROWS} rows")
    (header_row, header), *body = filled
    while header and not header[-1]:
        header.pop()
    _check_header(header, header_row)
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
