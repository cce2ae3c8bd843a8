"""Ranks: by error among pipelines that answer, and shared where units built alike disagree.

A rank that rests on one unit of a sensor says as much of that unit as of the pipelines. The
leading pipelines of each data set's first condition are scored on several units; a pipeline whose
errors on them overlap those of the best one before it shares its rank.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmark.contract import Cell
from benchmark.metrics.score import is_available

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Spread:
    """Errors of one pipeline on the units of a sensor.

    Attributes
    ----------
    errors_deg
        Root mean square error by unit, the standard one first; None where a unit gives none.
    """

    errors_deg: tuple[float | None, ...]

    @property
    def low_deg(self) -> float:
        """Smallest error of a unit; 0 where one gives none: nothing is known of it."""
        return min(0.0 if error is None else error for error in self.errors_deg)

    @property
    def high_deg(self) -> float:
        """Largest error of a unit; infinite where one gives none."""
        return max(math.inf if error is None else error for error in self.errors_deg)

    def overlaps(self, other: Spread) -> bool:
        """Say whether there are units of which either pipeline is the better."""
        return self.low_deg <= other.high_deg and other.low_deg <= self.high_deg


def order(numbers: Row, identity: object) -> tuple[Any, ...]:
    """Return the place of a score among those of its board: a key to sort by.

    By error; those that answer fewer than 95 % of the observable samples come behind all others,
    those without an error last. `identity` decides between equals.
    """
    error = numbers["charged_deg"]
    return (error is None, not is_available(numbers), error or 0.0, identity)


def spreads(rows: Iterable[Row]) -> dict[Cell, Spread]:
    """Return the spread of every pipeline that was scored on more units than one.

    Parameters
    ----------
    rows
        Of all units.
    """
    errors: dict[Cell, dict[int, float | None]] = {}
    for row in rows:
        cell = Cell(row["dataset"], row["condition"], row["extractor"], row["model"])
        errors.setdefault(cell, {})[row["unit"]] = row["rms_deg"]
    return {
        cell: Spread(tuple(by_unit[unit] for unit in sorted(by_unit)))
        for cell, by_unit in errors.items()
        if len(by_unit) > 1 and 0 in by_unit
    }


def ranks(ordered: Sequence[Row], spread: Sequence[Spread | None]) -> list[tuple[int | None, bool]]:
    """Give the rank of each row of a board, and whether it is shared.

    A row joins those before it where its spread overlaps that of the first of them; rows behind
    take the rank of their place. Without a spread a row stands alone, without an error it has no
    rank. Pipelines that answer enough and those that do not never share one.

    Parameters
    ----------
    ordered
        Rows of the standard unit, sorted by `order`.
    spread
        Of each row; None where it was scored on one unit.
    """
    found: list[int | None] = []
    first = 0
    for place, row in enumerate(ordered):
        if row["rms_deg"] is None:
            found.append(None)
            continue
        best, mine = spread[first], spread[place]
        shared = (
            place > 0
            and best is not None
            and mine is not None
            and mine.overlaps(best)
            and is_available(row) == is_available(ordered[first])
        )
        if not shared:
            first = place
        found.append(first + 1)
    return [(rank, rank is not None and found.count(rank) > 1) for rank in found]
