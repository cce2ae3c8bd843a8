"""Ranks: by own error over units among pipelines that answer, shared where nothing tells apart.

What can lead a board is scored on ten units of the sensor, what is behind on five. Pipelines rank
by the geometric mean of their errors over these; those that a paired test does not tell apart from
the first share its rank (`benchmark.metrics.paired`). What was scored on one unit alone is further
behind than units differ.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np

from benchmark.contract import Cell
from benchmark.metrics.score import is_available
from benchmark.metrics.separation import store

Row = Mapping[str, Any]

_LEAST_DEG = 1e-12


def luck_of_standard(errors: Iterable[UnitErrors]) -> float:
    """Return what units err over what the standard one does: the median over pipelines.

    A launch, or an age, is the same for all pipelines of a unit. An error of the standard unit
    alone, times this, compares with errors of several. 1 where of no pipeline several have one.
    """
    shares = [
        math.exp(math.fsum(map(math.log, one.known_deg)) / len(one.known_deg)) / one.known_deg[0]
        for one in errors
        if one.complete and min(one.known_deg) > 0
    ]
    return median(shares) if shares else 1.0


@dataclass(frozen=True)
class UnitErrors:
    """Errors of one pipeline on the units of a sensor.

    Attributes
    ----------
    errors_deg
        Root mean square error over all answers by unit, the standard one first; None where a unit
        gives none.
    """

    errors_deg: tuple[float | None, ...]

    @property
    def known_deg(self) -> tuple[float, ...]:
        """Errors of the units that give one."""
        return tuple(error for error in self.errors_deg if error is not None)

    @property
    def complete(self) -> bool:
        """Whether there are several units, and every one gives an error."""
        return len(self.errors_deg) > 1 and None not in self.errors_deg

    @property
    def own_error_deg(self) -> float | None:
        """Geometric mean over units; None where none gives an error."""
        logs = [math.log(max(error, _LEAST_DEG)) for error in self.known_deg]
        return store(math.exp(math.fsum(logs) / len(logs))) if logs else None

    @property
    def own_se(self) -> float | None:
        """Relative standard error of that mean; None for fewer than two units."""
        logs = np.log(np.maximum(self.known_deg, _LEAST_DEG))
        return store(float(np.std(logs, ddof=1)) / math.sqrt(len(logs))) if len(logs) > 1 else None

    @property
    def low_deg(self) -> float | None:
        """Smallest error of a unit; None for one unit, and where one gives none."""
        return min(self.known_deg) if self.complete else None

    @property
    def high_deg(self) -> float | None:
        """Largest error of a unit, likewise."""
        return max(self.known_deg) if self.complete else None


@dataclass(frozen=True)
class Place:
    """Where a pipeline stands on its board.

    Attributes
    ----------
    rank
        Of the first of its group; None without an error.
    group
        1 for what is not distinguished from the leader, 2 for what is not distinguished from the
        best of the others, and so on; None where it was scored on too few units, or on other units
        than the board's first condition has.
    tied
        Whether others share its rank.
    """

    rank: int | None
    group: int | None
    tied: bool


@dataclass(frozen=True)
class RankedBoard:
    """A board in order.

    Attributes
    ----------
    order
        Positions of the rows, best first.
    places
        By position.
    smallest_ratio
        Ratio to the leader from which on the board tells apart in nine of ten cases; None where
        nothing was compared.
    quoted_deg
        Error on the odd units of the pipeline that leads on the even ones; None for one unit.
    """

    order: tuple[int, ...]
    places: tuple[Place, ...]
    smallest_ratio: float | None = None
    quoted_deg: float | None = None


def order(numbers: Row, identity: object) -> tuple[Any, ...]:
    """Return the place of a score among those of its board: a key to sort by.

    By error over all answers; those that answer fewer than 95 % of the observable samples come
    behind all others, those without an error last. `identity` decides between equals.
    """
    error = numbers["rms_all_answers_deg"]
    return (error is None, not is_available(numbers), error or 0.0, identity)


def spreads(rows: Iterable[Row]) -> dict[Cell, UnitErrors]:
    """Return the errors of every pipeline of the standard unit, by unit; rows are of all units."""
    errors: dict[Cell, dict[int, float | None]] = {}
    for row in rows:
        cell = Cell(row["dataset"], row["condition"], row["extractor"], row["model"])
        errors.setdefault(cell, {})[row["unit"]] = row["rms_all_answers_deg"]
    return {
        cell: UnitErrors(tuple(by_unit[unit] for unit in sorted(by_unit)))
        for cell, by_unit in errors.items()
        if 0 in by_unit
    }


def own_errors(rows: Iterable[Row]) -> dict[tuple[str, str, str, str], float | None]:
    """Return own errors, degrees, by data set, condition, extractor and model; rows of all units.

    None where a pipeline has no score on the standard unit.
    """
    known = list(rows)
    scored = {
        (row["dataset"], row["condition"], row["extractor"], row["model"])
        for row in known
        if row["unit"] == 0 and row["status"] == "ok"
    }
    places = {
        (cell.dataset, cell.condition, cell.extractor, cell.model): errors.own_error_deg
        for cell, errors in spreads(known).items()
    }
    return {place: own if place in scored else None for place, own in places.items()}


def rank_board(rows: Sequence[Row], spread: Sequence[UnitErrors]) -> RankedBoard:
    """Order the rows of a board, and group what is not distinguished.

    Parameters
    ----------
    rows
        Of the standard unit.
    spread
        Errors of each row's pipeline.
    """
    from benchmark.metrics import paired  # noqa: PLC0415 - loads SciPy

    known = [at for at, row in enumerate(rows) if row["rms_deg"] is not None]
    ranked = [at for at in known if is_available(rows[at])] or known
    tested = [at for at in ranked if len(spread[at].known_deg) >= paired.FEWEST_UNITS]
    groups: dict[int, int] = {}
    smallest = quoted = None
    if tested:
        logs = paired.logarithms([spread[at].errors_deg for at in tested])
        leader = paired.best_method(logs)
        found = paired.groups(logs, leader)
        groups = {at: group for at, group in zip(tested, found, strict=True) if group is not None}
        smallest = paired.smallest_ratio(logs, leader)
        chosen = paired.best_method(logs[:, ::2])
        odd = logs[chosen, 1::2]
        quoted = math.exp(float(np.nanmean(odd))) if np.isfinite(odd).any() else None
    behind = 1 + max(groups.values(), default=0)

    def key(at: int) -> tuple[Any, ...]:
        row, own = rows[at], spread[at].own_error_deg
        nothing = own is None or row["rms_deg"] is None
        identity = row["extractor"], row["model"]
        return (nothing, at not in ranked, groups.get(at, behind), own or 0.0, identity)

    ordered = sorted(range(len(rows)), key=key)
    places: dict[int, Place] = {}
    first_of: dict[int, int] = {}
    for number, at in enumerate(ordered, start=1):
        group = groups.get(at)
        rank = number if group is None else first_of.setdefault(group, number)
        places[at] = Place(None if rows[at]["rms_deg"] is None else rank, group, tied=False)
    shared = {group for group in groups.values() if list(groups.values()).count(group) > 1}
    return RankedBoard(
        tuple(ordered),
        tuple(
            Place(places[at].rank, places[at].group, tied=places[at].group in shared)
            for at in range(len(rows))
        ),
        None if smallest is None else store(smallest),
        None if quoted is None else store(quoted),
    )
