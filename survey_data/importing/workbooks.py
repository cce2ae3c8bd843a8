"""Reading sheets of a workbook as a stream, bounded in bytes, cells and time.

What a sheet says of its own size is not believed: a single cell at its far corner would cost every
cell before it. Only cells that stand in the file are read, up to fixed numbers of them.
"""

from __future__ import annotations

import datetime as dt
import io
import re
import struct
import time
import warnings
import zipfile
import zlib
from collections.abc import Iterator

from survey_data.importing.cells import ERROR, FORMULA, Cell
from survey_data.problems import SurveyImportError

#: What an archive may unpack to, as a whole; read in streams, so that little of it is held at once.
LARGEST_BYTES = 60_000_000
LARGEST_ROWS = 20_000
LARGEST_COLUMNS = 256
LARGEST_CELLS = 300_000
LONGEST_CELL = 32_767  # Excel's own limit
LONGEST_SECONDS = 8.0
_MOST_MEMBERS = 2_000
_MOST_TAGS = 2_000_000  # of one part: an element of XML costs a hundred bytes of memory
#: Text and styles are held whole by whoever reads a workbook.
_LARGEST_HELD = 20_000_000

#: Kinds of cells that are not simply values.
Row = tuple[int, list[str]]


# openpyxl raises whatever a mangled part of the archive leads it to.
_MANGLED = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    OSError,
    EOFError,
    LookupError,
    ValueError,
    TypeError,
    AttributeError,
    ArithmeticError,
    SyntaxError,  # XML parse errors
    NotImplementedError,
    RuntimeError,  # encrypted members
    MemoryError,
    AssertionError,
)


def read_workbook(name: str, data: bytes, sheet: str | None) -> list[Row]:
    """Return the rows of a sheet as text, blank ones left out, each with its number.

    Parameters
    ----------
    name
        Of the file, for messages.
    data
        Its bytes.
    sheet
        Which; by default the first visible one that is not empty.

    Raises
    ------
    SurveyImportError
        For what is no workbook, is larger than the limits of this module, has no such sheet, has
        a formula without a value, an error value such as #N/A, or a truth value; naming the cell.
    """
    try:
        _require_small(name, data)
        rows = _Workbook(name, data).rows(sheet)
    except SurveyImportError:
        raise
    except _MANGLED as error:
        said = " ".join(str(error).split())[:200]
        raise SurveyImportError(f"{name} is not a readable XLSX workbook: {said}") from error
    # a row ends with its last filled cell, a table's with its header
    width = len(rows[0][1]) if rows else 0
    return [(number, cells + [""] * (width - len(cells))) for number, cells in rows]


def _require_small(name: str, data: bytes) -> None:
    """Refuse an archive by what it really unpacks to; its own list of sizes may lie."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = archive.infolist()
        if len(members) > _MOST_MEMBERS:
            raise SurveyImportError(f"{name} holds more than {_MOST_MEMBERS} files")
        if len({member.filename for member in members}) < len(members):
            raise SurveyImportError(f"{name} holds two files of one name")
        whole = 0
        for member in members:
            size = tags = 0
            with archive.open(member) as stream:
                while part := stream.read(1 << 20):
                    if (
                        not size and b"<!" in part[:4096]
                    ):  # definitions that multiply: no workbook has any
                        raise SurveyImportError(
                            f"{name}: {member.filename} defines entities of XML"
                        )
                    size += len(part)
                    whole += len(part)
                    tags += part.count(b"<")
                    if whole > LARGEST_BYTES:
                        raise SurveyImportError(
                            f"{name} unpacks to more than {LARGEST_BYTES} bytes"
                        )
                    if tags > _MOST_TAGS:
                        raise SurveyImportError(
                            f"{name}: {member.filename} has more than {_MOST_TAGS} tags, a table "
                            f"at most {LARGEST_CELLS} cells"
                        )
            if size > _LARGEST_HELD and "worksheets/" not in member.filename:
                raise SurveyImportError(
                    f"{name}: {member.filename} unpacks to more than {_LARGEST_HELD} bytes"
                )


class _Workbook:
    """A workbook opened as a stream."""

    def __init__(self, name: str, data: bytes) -> None:
        from openpyxl import load_workbook  # noqa: PLC0415 - most calls read CSV

        self._name = name
        self._until = time.monotonic() + LONGEST_SECONDS
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # styles and validations it drops are of no concern
            self._workbook = load_workbook(
                io.BytesIO(data), data_only=True, read_only=True, keep_links=False
            )

    def rows(self, wanted: str | None) -> list[Row]:
        sheets = {sheet.title: sheet for sheet in self._workbook.worksheets}
        if wanted is not None:
            if wanted not in sheets:
                raise SurveyImportError(
                    f"{self._name} has no sheet {wanted!r}; it has {', '.join(sheets)}"
                )
            return self._read(wanted)
        visible = [title for title, sheet in sheets.items() if sheet.sheet_state == "visible"]
        for title in visible:
            if rows := self._read(title):
                return rows
        hidden = [title for title in sheets if title not in visible]
        if any(self._read(title) for title in hidden):
            raise SurveyImportError(
                f"{self._name} has rows in hidden sheets alone ({', '.join(hidden)}); name one "
                "with --sheet"
            )
        return []

    def _read(self, title: str) -> list[Row]:
        """Return the rows of a sheet that hold anything."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return list(self._rows(title))

    def _rows(self, title: str) -> Iterator[Row]:
        from survey_data.importing.sheet_cells import cells_of  # noqa: PLC0415 - openpyxl's parser

        count = rows = before = 0
        without: list[str] = []
        for number, row in cells_of(self._workbook, title):
            if time.monotonic() > self._until:
                raise SurveyImportError(
                    f"{self._name} takes longer than {LONGEST_SECONDS:g} s to read"
                )
            if number <= before:
                raise SurveyImportError(f"row {number} stands twice or out of order", row=number)
            before = number
            count += len(row)
            if count > LARGEST_CELLS:
                raise SurveyImportError(f"{self._name} has more than {LARGEST_CELLS} cells")
            said = [(cell.column, self._text(f"sheet {title}", cell)) for cell in row]
            without += [_place(cell) for cell in row if cell.kind == FORMULA]
            if any(text for _, text in said):
                rows += 1
                if rows > LARGEST_ROWS:
                    raise SurveyImportError(f"{self._name} has more than {LARGEST_ROWS} rows")
                texts = [""] * max(column for column, text in said if text)
                for column, text in said:
                    if text:
                        texts[column - 1] = text
                yield number, texts
        if without:
            more = f" and {len(without) - 10} more" if len(without) > 10 else ""
            raise SurveyImportError(
                f"sheet {title}: formulas without a value in {', '.join(without[:10])}{more}; open "
                "the workbook where it was made, let it compute, and save it"
            )

    def _text(self, sheet: str, cell: Cell) -> str:
        """Spell a cell; one without a value is empty."""
        text = _format_value(cell.value)
        wrong = ""
        if cell.kind == ERROR:
            wrong = f"an error ({text}) is no value of a table"
        elif isinstance(cell.value, bool):
            wrong = f"a truth value ({text}) is no value of a table"
        elif text and cell.column > LARGEST_COLUMNS:
            wrong = f"a table has at most {LARGEST_COLUMNS} columns"
        elif len(text) > LONGEST_CELL:
            wrong = f"longer than {LONGEST_CELL} characters"
        if wrong:
            raise SurveyImportError(f"{sheet}, cell {_place(cell)}: {wrong}", row=cell.row)
        return text


def _place(cell: Cell) -> str:
    column, letters = cell.column, ""
    while column:
        column, left = divmod(column - 1, 26)
        letters = chr(ord("A") + left) + letters
    return f"{letters}{cell.row}"


def _format_value(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, float) and value.is_integer():
        return str(int(value)) if abs(value) < 1e15 else repr(value)
    if isinstance(value, dt.datetime):
        return value.date().isoformat() if value.time() == dt.time() else value.isoformat()
    return re.sub(r"_x000D_", "\r", str(value))
