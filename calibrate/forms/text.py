"""Text files and Excel workbooks as rows of cells: encoding, separator, header and units found."""

from __future__ import annotations

import codecs
import csv
import datetime as dt
import io
import re
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from calibrate.forms.layout import (
    SAMPLED,
    Layout,
    is_comment,
    layout_of,
    numeric_share,
    separator_of,
    without_mark,
)
from calibrate.settings import FileSettings

#: A row, a cell that does not state its place, another cell, and a text that cells refer to.
_ELEMENT = re.compile(rb"<(?:\w+:)?(?:(row)|(c)(?![^<>]*\sr=)|c|si)(?=[\s/>])")
#: A filled cell of a sheet by its place, and bytes that a sheet is looked through at a time.
_FILLED = re.compile(
    rb'<(?:\w+:)?c\s(?:[^<>]*?\s)?r="([A-Z]{1,3})([0-9]{1,7})"[^<>]*(?<!/)>(?=[^<]|<[^/])'
)
_STEP, _LONGEST_TAG = 2**20, 2**16


class TableError(ValueError):
    """A file that is no table of numbers: what was expected, what came, in which row and column."""


#: Marks at the start of a file and what they say; longer ones first.
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
#: Of bytes that are no UTF-8: one byte a letter, as instruments' software writes them.
_OTHERS = ["cp1252", "mac_roman", "cp850"]
_WITHOUT_MARK = ["utf_16_le", "utf_16_be"]
#: Signs of units, by which encodings that all fit are told apart.
_SIGNS = "°µαβθφ"
_SAMPLED = 50_000


def decoded(data: bytes, source: str, encoding: str | None = None) -> tuple[str, str]:
    """Return a file's text and the name of its encoding, which is found where it is not stated.

    TableError if the bytes are no text of that encoding, or hold null characters.
    """
    name = encoding or _encoding(data)
    try:
        text = data.decode(name)
    except (UnicodeDecodeError, UnicodeError, LookupError) as error:
        at = error.start if isinstance(error, UnicodeDecodeError) else 0
        row = data.count(b"\n", 0, at) + 1
        raise TableError(f"{source}, row {row}: expected {name} text ({error})"[:200]) from None
    if "\x00" in text:
        row = text.count("\n", 0, text.index("\x00")) + 1
        raise TableError(f"{source}, row {row}: a null character")
    return text.removeprefix("\ufeff"), name.removesuffix("-sig")


def _encoding(data: bytes) -> str:
    from charset_normalizer import from_bytes  # noqa: PLC0415 - for a file that is no UTF-8

    marked = next((name for mark, name in _MARKS if data.startswith(mark)), None)
    if marked is not None:
        return marked
    if b"\x00" in data and (found := from_bytes(data[:_SAMPLED], cp_isolation=_WITHOUT_MARK)):
        best = found.best()
        if best is not None:
            return best.encoding.replace("_", "-")
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        pass
    else:
        return "utf-8"
    matches = [one.encoding for one in from_bytes(data[:_SAMPLED], cp_isolation=_OTHERS)]
    known = [name for name in _OTHERS if name in matches] or ["cp1252"]
    text = {name: data[:_SAMPLED].decode(name, errors="replace") for name in known}
    return max(known, key=lambda name: sum(text[name].count(sign) for sign in _SIGNS))


_SEPARATORS = (";", "\t", ",", "|", " ")
_WORDS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", " ": "blanks"}
_ENDS = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True)
class Cells:
    """Cells of a table, before any is a number."""

    frame: pd.DataFrame  # of str, a column a place
    names: tuple[str, ...]  # empty where the header has none; none without a header
    units: tuple[str, ...]  # a cell a column, where the file has a row of units
    rows: NDArray[np.int64]  # (n,), of each row in the file, the first is 1
    decimal: str  # ``"."`` or ``","``
    header_row: int  # of the names, 0 for none
    notes: tuple[str, ...]  # how the file was read


def cells_of_text(data: bytes, source: str, stated: FileSettings, most_rows: int) -> Cells:
    """Return the cells of a text file, at most so many rows; what is not stated of it is found.

    TableError if rows have different numbers of cells, or it is no text.
    """
    text, encoding = decoded(data, source, stated.encoding)
    lines = _ENDS.split(text)
    comment = np.array([is_comment(line) for line in lines], dtype=np.bool_)
    blank = np.array([not line.strip() for line in lines], dtype=np.bool_)
    top = [line for line, skip in zip(lines[:SAMPLED], comment | blank, strict=False) if not skip]
    separator = stated.separator or separator_of(
        top, [(sign, _split(top, sign, source)) for sign in _SEPARATORS]
    )
    shown = [without_mark(line) if is_comment(line) else line for line in lines[:SAMPLED]]
    layout = layout_of(
        _split(shown, separator, source), comment[:SAMPLED].tolist(), stated.header_row
    )
    places = np.arange(len(lines))
    kept = (places >= layout.data) & ~comment & ~blank
    rows = places[kept] + 1
    if len(rows) > most_rows:
        raise TableError(f"{source}: expected at most {most_rows} rows; got more")
    body = [lines[at] for at in rows - 1]
    frame, layout = _frame(body, rows, layout, separator, source)
    decimal = stated.decimal or ("," if separator != "," and _decimal_commas(body) else ".")
    between = int(comment.sum()) - int(layout.header is not None and comment[layout.header])
    notes = _notes(encoding, separator, decimal, layout, between)
    return Cells(
        frame, layout.names, layout.unit_cells, rows, decimal, layout.header_row, tuple(notes)
    )


def _split(lines: Sequence[str], separator: str, source: str) -> list[list[str]]:
    if separator == " ":
        return [line.split() for line in lines]
    rows = []
    for at, line in enumerate(lines):
        try:
            rows.append(next(csv.reader([line], delimiter=separator, skipinitialspace=True), []))
        except csv.Error as error:
            raise TableError(f"{source}, row {at + 1}: expected cells ({error})") from None
    return rows


def _frame(
    body: Sequence[str], rows: NDArray[np.int64], layout: Layout, separator: str, source: str
) -> tuple[pd.DataFrame, Layout]:
    """Return the data's cells, and the layout with as many names as there are columns."""
    split = _split(body[:SAMPLED], separator, source)
    widths = [len(row) for row in split]
    usual = max(set(widths), key=widths.count) if widths else len(layout.names)
    names = layout.names
    if names and usual == len(names) + 1:
        ends = all(not row[-1].strip() for row in split if len(row) == usual)
        names = (*names, "") if ends else ("", *names)
    elif names and usual == len(names) - 1 and not names[-1]:
        names = names[:-1]
    width = len(names) or usual
    _require_even(body, rows, width, separator, source)
    blanks = separator == " "
    frame = (
        pd.read_csv(
            io.StringIO("\n".join(body)),
            sep=r"\s+" if blanks else separator,
            header=None,
            names=list(range(width)),
            index_col=False,
            dtype=str,
            keep_default_na=False,
            na_filter=False,
            skipinitialspace=True,
            skip_blank_lines=False,
        )
        if body
        else pd.DataFrame({at: pd.Series([], dtype=str) for at in range(width)})
    )
    if len(frame) != len(body):
        raise TableError(f"{source}: expected a row a line; a quoted cell goes over several")
    return frame, Layout(layout.header, layout.units, layout.data, names, layout.unit_cells)


def _require_even(
    body: Sequence[str], rows: NDArray[np.int64], width: int, separator: str, source: str
) -> None:
    """Raise TableError naming the first row with another number of cells."""
    for row, line in zip(rows, body, strict=True):
        if separator == " ":
            count = len(line.split())
        elif '"' in line:
            count = len(_split([line], separator, source)[0])
        else:
            count = line.count(separator) + 1
        if count != width:
            raise TableError(f"{source}, row {row}: expected {width} cells; got {count}")


def _decimal_commas(body: Sequence[str]) -> bool:
    sample = "".join(body[:SAMPLED])
    return sample.count(",") > sample.count(".")


def _notes(encoding: str, separator: str, decimal: str, layout: Layout, comments: int) -> list[str]:
    word = _WORDS.get(separator, repr(separator))
    said = [f"text in {encoding.upper()}, cells separated by {word}"]
    if decimal == ",":
        said.append("numbers have decimal commas")
    said += layout.notes()
    if comments:
        said.append(f"{comments} comment line{'s' if comments > 1 else ''} left out")
    return said


def extent_of_workbook(data: bytes, most: int) -> tuple[int, int, int]:
    """Return the last row and column of any sheet that a filled cell stands in, and its elements.

    By the cells' own places, before any is read: a reader makes every cell up to the last one.
    Elements are rows, cells, filled or empty, and texts; it is read on to `most` of them.
    """
    rows, columns, width, count = 0, b"", 0, 0
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        for name in archive.namelist():
            with archive.open(name) as part:
                text, row = b"", b""
                while (more := part.read(_STEP)) and count <= most:
                    text = text[-_LONGEST_TAG:] + more
                    for column, number in _FILLED.findall(text):
                        rows = max(rows, int(number))
                        columns = max(columns, column.rjust(3))
                    elements = _ELEMENT.findall(more)
                    count += len(elements)
                    in_rows = (row + b"".join(begin[:1] + cell for begin, cell in elements)).split(
                        b"r"
                    )
                    width = max(width, *map(len, in_rows))
                    row = in_rows[-1]
    placed = 0
    for letter in columns.strip():
        placed = 26 * placed + letter - ord("A") + 1
    return rows, max(width, placed), count


def cells_of_workbook(data: bytes, source: str, stated: FileSettings, most_rows: int) -> Cells:
    """Return the cells of a workbook's sheet, by default of the one with most numbers.

    TableError if it is no workbook, or has no such sheet.
    """
    try:
        sheets = pd.read_excel(
            io.BytesIO(data), sheet_name=None, header=None, nrows=most_rows, dtype=object
        )
    except Exception as error:  # noqa: BLE001 - openpyxl raises many kinds for damaged files
        raise TableError(f"{source}: expected an Excel workbook ({str(error)[:80]})") from None
    if stated.sheet is not None and stated.sheet not in sheets:
        raise TableError(
            f"{source}: no sheet {stated.sheet!r} (there are {', '.join(map(str, sheets))})"
        )
    texts = {str(name): sheet.map(_as_text) for name, sheet in sheets.items()}
    name = stated.sheet or max(texts, key=lambda word: _numbers_in(texts[word]))
    frame = texts[name]
    top = [[str(cell) for cell in row] for row in frame.head(SAMPLED).itertuples(index=False)]
    comments = [bool(row) and is_comment(row[0]) for row in top]
    layout = layout_of(top, comments, stated.header_row)
    places = np.arange(len(frame))
    blank = (frame == "").all(axis=1).to_numpy(dtype=np.bool_)
    kept = (places >= layout.data) & ~blank
    sheet = [f"sheet {name} of {', '.join(texts)} was read"] if len(sheets) > 1 else []
    body = frame[kept].reset_index(drop=True)
    notes = (*sheet, *layout.notes())
    return Cells(
        body, layout.names, layout.unit_cells, places[kept] + 1, ".", layout.header_row, notes
    )


def _numbers_in(sheet: pd.DataFrame) -> float:
    """Numbers of a sheet, estimated by its first rows."""
    rows = [list(row) for row in sheet.head(SAMPLED).itertuples(index=False)]
    shares = [max(numeric_share(row), 0.0) * len(row) for row in rows]
    return float(np.mean(shares)) * len(sheet) if shares else 0.0


def _as_text(cell: object) -> str:
    if isinstance(cell, (dt.datetime, dt.date)):
        return cell.isoformat()
    if cell is None or cell is pd.NaT or (isinstance(cell, float) and np.isnan(cell)):
        return ""
    return str(cell).strip()
