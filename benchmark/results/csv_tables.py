"""Tables of numbers as CSV that compares line by line: rows sorted, digits few, empty for none."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from files.csv_writing import csv_text
from files.reading import FileRefusedError, parse_decimal, parse_integer, read_text

Row = dict[str, Any]
Reader = Callable[[str], Any]
_Number = TypeVar("_Number", int, float)


class StoreError(ValueError):
    """A stored file cannot be read; the message names file and line."""


def number(text: str) -> float | None:
    """Read a finite number, None from an empty cell; ValueError for anything else."""
    return parse_decimal(text) if text else None


def size(text: str) -> float | None:
    """Read a number that is not negative, None from an empty cell; ValueError for others."""
    return _within(number(text), 0.0)


def above_zero(text: str) -> float | None:
    """Read a number above 0, None from an empty cell; ValueError for anything else."""
    found = number(text)
    if found is not None and found <= 0.0:
        raise ValueError(f"expected a number above 0, got {text!r}")
    return found


def share(text: str) -> float | None:
    """Read a number from 0 to 1, None from an empty cell; ValueError for anything else."""
    return _within(number(text), 0.0, 1.0)


def parse_whole(text: str) -> int | None:
    """Read a whole number, None from an empty cell; ValueError for anything else."""
    return parse_integer(text) if text else None


def count(text: str) -> int | None:
    """Read a whole number that is not negative, None from an empty cell; ValueError for others."""
    return _within(parse_whole(text), 0)


def one_of(*words: str) -> Reader:
    """Return a reader of one of these words; ValueError for any other."""

    def known(text: str) -> str:
        if text not in words:
            raise ValueError(f"expected one of {', '.join(words)}, got {text!r}")
        return text

    return known


def _within(found: _Number | None, least: float, most: float | None = None) -> _Number | None:
    if found is not None and (found < least or (most is not None and found > most)):
        limits = f"from {least:g} to {most:g}" if most is not None else f"of at least {least:g}"
        raise ValueError(f"expected a number {limits}, got {found:g}")
    return found


def word(text: str) -> str:
    """Read text as it is; ValueError where there is none."""
    if not text:
        raise ValueError("expected a word, got an empty cell")
    return text


def format_cell(value: object) -> str:
    """Spell a cell: the fewest digits that read back alike, empty for None."""
    if value is None:
        return ""
    if isinstance(value, float):
        # as short as repr, without a point that says nothing
        return repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    return str(value)


def text_of(columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> str:
    """Write rows as CSV under a header; columns a row lacks are empty."""
    return csv_text(columns, ([format_cell(row.get(name)) for name in columns] for row in rows))


def read_csv(path: Path, columns: Mapping[str, Reader]) -> list[tuple[int, Row]]:
    """Read (line number, row) of a table; nothing where there is no file.

    StoreError for what is no file of text, another header, a line of other cells than columns, a
    cell that cannot be read, or a last line that is cut off.
    """
    try:
        text = read_text(path)
    except FileNotFoundError:
        return []
    except FileRefusedError as error:
        raise StoreError(str(error)) from error
    lines = csv.reader(io.StringIO(text, newline=""), strict=True)
    found: list[tuple[int, Row]] = []
    try:
        header = next(lines, [])
        readers = list(columns.items())
        if header != list(columns):
            raise StoreError(
                f"{path}, line 1: expected the columns {', '.join(columns)}; "
                f"got {', '.join(header) or 'none'}"
            )
        for cells in lines:
            where = f"{path}, line {lines.line_num}"
            if len(cells) != len(readers):
                raise StoreError(f"{where}: expected {len(readers)} cells, got {len(cells)}")
            found.append((lines.line_num, _row(cells, readers, where)))
    except csv.Error as error:
        raise StoreError(f"{path}, line {lines.line_num}: not CSV ({error})") from error
    if not text.endswith("\n"):
        raise StoreError(f"{path}, line {lines.line_num}: the last line is cut off")
    return found


def _row(cells: Sequence[str], readers: Sequence[tuple[str, Reader]], where: str) -> Row:
    row = {}
    for cell, (name, reader) in zip(cells, readers, strict=True):
        try:
            row[name] = reader(cell)
        except ValueError as error:
            raise StoreError(f"{where}, column {name}: {error}") from error
    return row
