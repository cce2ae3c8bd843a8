"""Rows of text laid out in columns that fit a width.

A table that is too wide for a line is stacked: every row takes the same few lines, and so does the
heading. Cells are wrapped and never cut; a number is never divided, nor is a word that fits a line.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

GAP = 2  # between columns
INDENT = "  "  # of the second and further lines of a stacked row
SHORT = 12  # a cell of no more characters is not divided
PROSE = 32  # a cell of more characters is read as prose, for which
PROSE_LEAST = 24  # a narrower column is no use

_PIECE = re.compile(r"[^-/_.,;=&?+]*[-/_.,;=&?+]+|[^-/_.,;=&?+]+")


@dataclass(frozen=True, eq=False)
class Column:
    """A column: its heading, the text of each row, and whether these are numbers."""

    heading: str
    cells: Sequence[str]
    numeric: bool = False

    @property
    def words(self) -> int:
        """Characters of the longest word of the heading."""
        return max(map(len, self.heading.split()), default=0)

    @property
    def longest(self) -> int:
        """Characters of the longest cell, or word of the heading."""
        return max([self.words, *map(len, self.cells)])

    @property
    def min_width(self) -> int:
        """Characters below which the column is hard to read."""
        if self.numeric:
            return self.longest
        words = itertools.chain.from_iterable(map(str.split, self.cells))
        word = max((min(len(word), PROSE) for word in words), default=0)
        short = max((len(cell) for cell in self.cells if len(cell) <= SHORT), default=0)
        prose = PROSE_LEAST if self.longest > PROSE else 0
        return max(self.words, word, short, prose)


@dataclass(frozen=True)
class Layout:
    """Lines of a table: those of its heading, and those of all rows."""

    heading: tuple[str, ...]
    rows: tuple[str, ...]

    @property
    def width(self) -> int:
        """Characters of the longest line."""
        return max(map(len, (*self.heading, *self.rows)), default=0)


def laid_out(columns: Sequence[Column], width: int, indent: str = "") -> Layout:
    """Lay columns out in lines of at most `width` characters.

    Parameters
    ----------
    columns : of as many cells each; those that say which row it is come first
    width : at least 20
    indent : before every line

    Returns
    -------
    Layout
        Lines without space at their end.
    """
    room = width - len(indent)
    stack = _stack(columns, room)
    heading: list[str] = []
    for before, line in stack:
        heading += _lines([(column, column.heading) for column in line], line, indent + before)
    rows: list[str] = []
    for at in range(len(columns[0].cells) if columns else 0):
        for place, (before, line) in enumerate(stack):
            cells = [(column, column.cells[at]) for column in line]
            if place == 0 or any(text for _, text in cells):
                rows += _lines(cells, line, indent + before)
    return Layout(tuple(heading), tuple(rows))


def wrap(text: str, width: int) -> list[str]:
    """Return text in lines of at most `width` characters; only a word longer than that is divided.

    Such a word is divided behind a hyphen or another mark where it has one.
    """
    lines: list[str] = []
    line = ""
    for word in text.split():
        for place, piece in enumerate(_pieces(word, width)):
            joined = f"{line}{' ' if line and not place else ''}{piece}"
            if line and len(joined) > width:
                lines.append(line)
                line = piece
            else:
                line = joined
    return [*lines, line] if line else lines


def _pieces(word: str, width: int) -> Iterator[str]:
    if len(word) <= width:
        yield word
        return
    for piece in _PIECE.findall(word):
        for start in range(0, len(piece), width):
            yield piece[start : start + width]


Line = dict[Column, int]  # columns that stand side by side, and the width of each


def _stack(columns: Sequence[Column], room: int) -> list[tuple[str, Line]]:
    """Return the lines of a row, each with its indent and the widths of its columns."""
    lines: list[list[Column]] = [[]]
    for column in columns:
        before = 0 if len(lines) == 1 else len(INDENT)
        taken = sum(other.min_width + GAP for other in lines[-1])
        if lines[-1] and before + taken + column.min_width > room:
            lines.append([])
        lines[-1].append(column)
    return [
        (before, _widths(line, room - len(before)))
        for line, before in zip(
            lines, itertools.chain([""], itertools.repeat(INDENT)), strict=False
        )
    ]


def _widths(columns: Sequence[Column], room: int) -> Line:
    """Share a line: what each column cannot do without, then what it would like to have."""
    free = room - GAP * (len(columns) - 1)
    widths = [min(column.min_width, free) for column in columns]
    spare = free - sum(widths)
    liked = [column.longest for column in columns]
    whole = [max(column.longest, len(column.heading)) for column in columns]
    for wanted in (liked, whole):
        # What wants least first: it may be content with less than its share.
        order = sorted(range(len(columns)), key=lambda at: wanted[at] - widths[at])
        for place, at in enumerate(order):
            more = max(0, min(wanted[at] - widths[at], spare // (len(order) - place)))
            widths[at] += more
            spare -= more
    return dict(zip(columns, widths, strict=True))


def _lines(cells: Sequence[tuple[Column, str]], widths: Line, before: str) -> Iterator[str]:
    """Yield the lines of cells side by side, each wrapped in its column."""
    parts = [wrap(text, widths[column]) for column, text in cells]
    for texts in itertools.zip_longest(*parts, fillvalue=""):
        line = (" " * GAP).join(
            text.rjust(widths[column]) if column.numeric else text.ljust(widths[column])
            for (column, _), text in zip(cells, texts, strict=True)
        )
        yield f"{before}{line}".rstrip()
