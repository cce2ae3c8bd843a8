"""Strict reading of the project's own CSV files: every flaw of form is located.

The tables keep one record a line, so that a broken quote is caught on the line where it stands
instead of swallowing the rest of the file.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from files.problems import Problem

_CELL = re.compile(r'(?:"([^"]*(?:""[^"]*)*)"|([^",]*))(,|\Z)')
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")
_LONGEST_CELL = 5000
_BOM = b"\xef\xbb\xbf"


@dataclass
class Records:
    """A CSV file as text cells.

    `rows` holds (row number in the file, cells); `problems` every flaw of form. Where there is a
    problem, `rows` holds only the sound rows.
    """

    header: list[str] = field(default_factory=list)
    rows: list[tuple[int, list[str]]] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)


def read_records(path: Path, columns: Sequence[str]) -> Records:
    """Read a CSV file (UTF-8, comma, double quotes, one record a line).

    Parameters
    ----------
    path : Path
        The file.
    columns : sequence of str
        The columns it must have, in this order.

    Returns
    -------
    Records
        Never raises for what the file holds or for a file that is not there: flaws are listed.
    """
    records = Records()
    try:
        data = path.read_bytes()
    except OSError as error:
        reason = "is missing" if isinstance(error, FileNotFoundError) else "cannot be read"
        records.problems.append(Problem(path.name, None, None, f"the file {reason}"))
        return records
    reader = _LineReader(path.name, records, list(columns))
    if data.startswith(_BOM):
        reader.report(1, 0, "starts with a byte-order mark; expected plain UTF-8")
        data = data[len(_BOM) :]
    lines = data.split(b"\n")
    if lines[-1] == b"":
        lines.pop()
    if not lines:
        reader.report(1, 0, f"the file is empty; expected the columns {', '.join(columns)}")
    for number, line in enumerate(lines, start=1):
        reader.read(number, line.removesuffix(b"\r"))
    return records


@dataclass
class _LineReader:
    """Reads line after line into `records`, naming every flaw's column."""

    file: str
    records: Records
    columns: list[str]

    def report(self, row: int, index: int, message: str) -> None:
        """Add a problem at the cell of this index (columns beyond the last count as the last)."""
        column = self.columns[min(index, len(self.columns) - 1)]
        self.records.problems.append(Problem(self.file, row, column, message))

    def read(self, number: int, line: bytes) -> None:
        """Take one line: the header if it is the first, else a row of cells."""
        cells = self._cells(number, line)
        if cells is None:
            return
        if number == 1:
            self.records.header = cells
            self._check_header()
            return
        if not any(cells):
            self.report(number, 0, "the row is blank")
        elif len(cells) > len(self.columns):
            extra = len(cells) - len(self.columns)
            self.report(number, len(cells), f"{extra} cells too many: {cells[-extra:]}")
        elif len(cells) < len(self.columns):
            self.report(
                number,
                len(cells),
                f"the cell is missing: the row has {len(cells)} cells, "
                f"expected {len(self.columns)}",
            )
        elif self._cells_are_clean(number, cells):
            self.records.rows.append((number, cells))

    def _cells(self, number: int, line: bytes) -> list[str] | None:
        try:
            text = line.decode("utf-8")
        except UnicodeDecodeError as error:
            index = _cell_index(line[: error.start].decode("utf-8", "replace"))
            self.report(number, index, f"not UTF-8: byte 0x{line[error.start]:02x}")
            return None
        control = _CONTROL.search(text)
        if control is not None:
            index = _cell_index(text[: control.start()])
            self.report(number, index, f"control character 0x{ord(control.group()):02x}")
            return None
        cells: list[str] = []
        position = 0
        while True:
            match = _CELL.match(text, position)
            if match is None:
                opened = text.startswith('"', position)
                what = "a quote is opened and not closed" if opened else "a stray quote"
                self.report(number, len(cells), f"broken CSV: {what}")
                return None
            quoted, plain, end = match.groups()
            cells.append(plain if quoted is None else quoted.replace('""', '"'))
            if not end:
                return cells
            position = match.end()

    def _check_header(self) -> None:
        header = self.records.header
        for column in self.columns:
            if header.count(column) != 1:
                what = "missing" if column not in header else "there twice"
                self.records.problems.append(
                    Problem(self.file, 1, column, f"the column is {what}; the header is {header}")
                )
        for name in header:
            if name not in self.columns:
                self.records.problems.append(
                    Problem(self.file, 1, name, f"unknown column; expected {self.columns}")
                )
        if sorted(header) == sorted(self.columns) and header != self.columns:
            self.report(1, 0, f"columns in another order; expected {self.columns}")

    def _cells_are_clean(self, number: int, cells: list[str]) -> bool:
        before = len(self.records.problems)
        for index, cell in enumerate(cells):
            if cell != cell.strip():
                self.report(number, index, f"space around the value {cell!r}")
            elif len(cell) > _LONGEST_CELL:
                self.report(number, index, f"longer than {_LONGEST_CELL} characters")
        return len(self.records.problems) == before


def _cell_index(prefix: str) -> int:
    """Index of the cell a line's prefix ends in."""
    rest = re.sub(r'"[^"]*"', "", prefix)
    return rest.partition('"')[0].count(",")
