"""What every rule reads cells with, and the problem that it finds there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

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


def known_values(frames: Frames) -> dict[tuple[str, str], set[str]]:
    """Return the known values of each study and attribute."""
    found: dict[tuple[str, str], set[str]] = {}
    for _, (study, attribute, value) in texts(frames["attributes"], "study", "attribute", "value"):
        if value:
            found.setdefault((study, attribute), set()).add(value)
    return found
