"""Strict reading of CSV tables as text cells: every flaw of form is located.

The tables keep one record a line, so that a broken quote is caught on the line where it stands
instead of swallowing the rest of the file.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from files.reading import FileRefusedError, read_text
from survey_data.descriptor import column_types, file_name
from survey_data.problems import Problem

_LONGEST_CELL = 5000


@dataclass
class Records:
    """A CSV file as text cells.

    `rows` holds (row number in the file, cells); `problems` every flaw of form. Where there is a
    problem, `rows` holds only the sound rows.
    """

    header: list[str] = field(default_factory=list)
    rows: list[tuple[int, list[str]]] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)


def read_table_records(folder: Path, table: str) -> Records:
    """Read a table of a folder as `read_records` does; problems name its file there."""
    name = file_name(table)
    records = read_records(folder / name, list(column_types(table)))
    records.problems = [replace(each, file=name) for each in records.problems]
    return records


def read_records(path: Path, columns: Sequence[str]) -> Records:
    """Read a CSV file (plain UTF-8, comma, double quotes, one record a line) of these columns.

    Never raises for what the file holds or for a file that is not there: flaws are listed.
    """
    try:
        lines = read_text(path).split("\n")
    except FileNotFoundError:
        return Records(problems=[Problem(path.name, None, None, "the file is missing")])
    except FileRefusedError as error:
        column = None if error.line is None else columns[0]
        return Records(problems=[Problem(path.name, error.line, column, error.reason)])
    records = Records()
    flaws: list[tuple[int, int, str]] = []
    if lines.pop():
        flaws.append((len(lines) + 1, len(columns), "the last line is cut off"))
    if not lines:
        flaws.append((1, 0, f"the file is empty; expected the columns {', '.join(columns)}"))
    for number, line in enumerate(lines, start=1):
        try:
            cells = next(csv.reader([line.removesuffix("\r")], strict=True), [])
        except csv.Error as error:
            flaws.append((number, 0, f"broken CSV: {error}"))
            continue
        found = _flaws(cells, columns, line) if number > 1 else _header_flaws(cells, columns)
        flaws += [(number, index, message) for index, message in found]
        if number == 1:
            records.header = cells
        elif not found:
            records.rows.append((number, cells))
    for number, index, message in flaws:
        column = columns[min(index, len(columns) - 1)]
        records.problems.append(Problem(path.name, number, column, message))
    return records


def _header_flaws(header: list[str], columns: Sequence[str]) -> list[tuple[int, str]]:
    """Return the first place where a header is another than expected, and what is wrong there."""
    for index, name in enumerate(columns):
        if header[index : index + 1] != [name]:
            found = header[index] if index < len(header) else "no more"
            return [(index, f"expected the columns {', '.join(columns)}; got {found} for {name}")]
    return [(len(columns), f"unknown column {header[-1]}")] if len(header) > len(columns) else []


def _flaws(cells: list[str], columns: Sequence[str], line: str) -> list[tuple[int, str]]:
    if not any(cells):
        return [(0, "the row is blank")]
    if len(cells) != len(columns):
        return [(len(cells), f"expected {len(columns)} cells, got {len(cells)}")]
    flaws = []
    for index, cell in enumerate(cells):
        if cell != cell.strip():
            flaws.append((index, f"space around the value {cell!r}"))
        elif len(cell) > _LONGEST_CELL:
            flaws.append((index, f"longer than {_LONGEST_CELL} characters"))
        elif '"' in cell and cell.replace('"', '""') not in line:
            flaws.append((index, f"broken CSV: a stray quote in {cell[:80]!r}"))
        elif not cell.isprintable():
            flaws.append((index, f"a control character in {cell[:80]!r}"))
    return flaws
