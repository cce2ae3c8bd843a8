"""Where a table's header, units and data stand among title rows and comments."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from calibrate.forms.cells import BLANK, looks_numeric
from calibrate.forms.units import unit_of

#: Rows from the top among which the header is looked for.
SAMPLED = 400
#: Share of a row's cells that look like numbers in a row of data.
_NUMERIC = 0.5
_COMMENT = re.compile(r"\s*(#|%|//|;|!)+\s*")


@dataclass(frozen=True)
class Layout:
    """Places of a table's parts, rows counted from 0."""

    header: int | None  # row of names
    units: int | None  # row of units
    data: int  # first row of data
    names: tuple[str, ...] = ()  # none where there is no header
    unit_cells: tuple[str, ...] = ()

    @property
    def header_row(self) -> int:
        """Number of the row of names in the file, the first is 1; 0 for none."""
        return 0 if self.header is None else self.header + 1

    def notes(self) -> list[str]:
        """Return what is said of the header and of units."""
        said = []
        if self.header is None:
            said.append("there is no header: columns are called column_1, column_2, ...")
        elif self.header > 0:
            said.append(f"the header is row {self.header_row}")
        if self.units is not None:
            said.append(f"row {self.units + 1} holds units")
        return said


def is_comment(line: str) -> bool:
    """Say whether a line is a comment: it starts with ``#``, ``%``, ``//``, ``;`` or ``!``."""
    return _COMMENT.match(line) is not None


def without_mark(line: str) -> str:
    """Return what a comment says."""
    return _COMMENT.sub("", line, count=1)


def numeric_share(cells: Sequence[str]) -> float:
    """Return the share of a row's cells that look like numbers; -1 where all are blank."""
    filled = [cell for cell in cells if cell.strip().lower() not in BLANK]
    if not filled:
        return -1.0
    return sum(looks_numeric(cell) for cell in filled) / len(filled)


def layout_of(
    rows: Sequence[Sequence[str]], comments: Sequence[bool], header_row: int | None = None
) -> Layout:
    """Return where the parts of a table stand.

    Rows are cells from the top of the file, of a comment those behind its mark. The row of names is
    counted in the file from 1, 0 for none; it is found where it is not stated.
    """
    if header_row is not None:
        header = header_row - 1
        units = _units_at(rows, comments, header + 1) if header >= 0 else None
        start = header + 1 if units is None else units + 1
        return _layout(rows, header if header >= 0 else None, units, start)
    filled = [at for at, row in enumerate(rows) if any(cell.strip() for cell in row)]
    plain = [at for at in filled if not comments[at]]
    found = next((at for at in plain if _is_data(rows, plain, at)), None)
    if found is None:  # nothing but names, or no numbers at all
        first = plain[0] if plain else None
        return _layout(rows, first, None, 0 if first is None else first + 1)
    data = found
    above = [at for at in plain if at < data]
    if not above:
        width = len(rows[data])
        said = [at for at in filled if at < data and comments[at]]
        above = [at for at in said if abs(len(rows[at]) - width) <= 1 and _could_be_names(rows[at])]
    units = None
    if len(above) > 1 and _are_units(rows[above[-1]]) and not _are_units(rows[above[-2]]):
        units = above[-1]
        above = above[:-1]
    return _layout(rows, above[-1] if above else None, units, data)


def _layout(
    rows: Sequence[Sequence[str]], header: int | None, units: int | None, data: int
) -> Layout:
    names = () if header is None else tuple(cell.strip() for cell in rows[header])
    cells = () if units is None else tuple(cell.strip() for cell in rows[units])
    return Layout(header, units, data, names, cells)


def _units_at(rows: Sequence[Sequence[str]], comments: Sequence[bool], at: int) -> int | None:
    here = at < len(rows) and not comments[at] and _are_units(rows[at])
    return at if here else None


def _is_data(rows: Sequence[Sequence[str]], plain: Sequence[int], at: int) -> bool:
    """Say whether a row is one of data: mostly numbers, as wide as most rows of numbers."""
    if numeric_share(rows[at]) < _NUMERIC:
        return False
    numeric = Counter(len(rows[other]) for other in plain if numeric_share(rows[other]) >= _NUMERIC)
    usual = numeric.most_common(1)[0][0]
    # a title may be a number; rows of data of another width are told to the reader later
    return len(rows[at]) == usual or len(rows[at]) > 1


def _are_units(cells: Sequence[str]) -> bool:
    filled = [cell for cell in cells if cell.strip()]
    return bool(filled) and all(unit_of(cell) is not None for cell in filled)


def _could_be_names(cells: Sequence[str]) -> bool:
    filled = [cell for cell in cells if cell.strip()]
    return len(filled) > 1 and not any(looks_numeric(cell) for cell in filled)


def separator_of(lines: Sequence[str], split: Sequence[tuple[str, Sequence[Sequence[str]]]]) -> str:
    """Return the separator under which most cells of most lines are numbers, in columns.

    Lines are neither blank nor comments; `split` has each separator, the most telling first, and
    the cells of each line under it.
    """
    best, found = 0.0, split[0][0]
    for separator, rows in split:
        wide = [row for row in rows if len(row) > 1]
        shares = [max(numeric_share(row), 0.0) for row in wide]
        widths = Counter(len(row) for row in wide)
        even = widths.most_common(1)[0][1] / len(wide) if wide else 0.0
        score = sum(shares) / max(len(lines), 1) * even
        if score > best + 1e-9:
            best, found = score, separator
    if best > 0:
        return found
    # nothing is a number: as many columns as the first line has
    counted = {separator: len(rows[0]) if rows else 0 for separator, rows in split}
    return max(counted, key=lambda word: counted[word])
