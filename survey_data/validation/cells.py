"""What every rule reads cells with, and the problem that it finds there."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping

import pandas as pd

from survey_data.descriptor import file_name
from survey_data.problems import Problem
from survey_data.tables import FIRST_ROW

Frames = Mapping[str, pd.DataFrame]
Rule = Callable[[Frames], Iterator[Problem]]


def problem(table: str, index: int, column: str, message: str) -> Problem:
    """Return a problem of a frame's row, as counted in its file."""
    return Problem(file_name(table), index + FIRST_ROW, column, message)


def texts(frame: pd.DataFrame, *columns: str) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Yield (index, cells as text, '' where missing) of some columns."""
    yield from enumerate(zip(*(_texts(frame[name]) for name in columns), strict=True))


def _texts(column: pd.Series) -> list[str]:
    # Python walks lists several times as fast as columns.
    cells = zip(column.tolist(), column.isna().tolist(), strict=True)
    return ["" if missing else str(cell) for cell, missing in cells]


def foreign(
    frames: Frames, table: str, column: str, known: Collection[str], message: str
) -> Iterator[Problem]:
    """Yield a problem for each cell of a column that is stated and none of the known ones."""
    for index, (cell,) in texts(frames[table], column):
        if cell and cell not in known:
            yield problem(table, index, column, message.format(cell))


def of_study(
    frames: Frames, table: str, attribute: str, columns: Iterable[str]
) -> Iterator[Problem]:
    """Yield a problem for each cell that is no known value of its study's attribute.

    `attribute` is one of a study, or empty where a column of the table names it.
    """
    known = known_values(frames)
    for column in columns:
        names = ("study", column) if attribute else ("study", column, "attribute")
        for index, (study, value, *named) in texts(frames[table], *names):
            of = attribute or named[0]
            if value not in known.get((study, of), ()):
                yield problem(table, index, column, f"{study} has no {of} {value!r}")


def cells_of(frames: Frames, table: str, name: str) -> set[str]:
    """Return the different cells of a column."""
    return {cell for _, (cell,) in texts(frames[table], name)}


def known_values(frames: Frames) -> dict[tuple[str, str], set[str]]:
    """Return the known values of each study and attribute."""
    found: dict[tuple[str, str], set[str]] = {}
    for _, (study, attribute, value) in texts(frames["attributes"], "study", "attribute", "value"):
        if value:
            found.setdefault((study, attribute), set()).add(value)
    return found
