"""Cells of a file that hold no reading: sentinels, saturated and clipped values, repeated rows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from calibrate.exclusions import DUPLICATE, Excluded
from calibrate.forms.units import DEGREES
from calibrate.readings import FAINT, Readings, directions_of, runs_of
from calibrate.settings import Settings
from calibrate.table import Table

#: Times that a value stands in a column to be a sentinel, and its distance to every other value
#: over their spread: readings, and directions, of which a coarse grid has few values.
_REPEATED, _FAR_OFF, _FAR_OFF_ANGLE = 2, 0.5, 3.0
#: Different values of a column from which sentinels are told.
_FEWEST_VALUES = 20
#: Times that a value stands at an end of a column to be clipped, and over the most of the values
#: next to it.
_CLIPPED, _OVER_NEXT, _NEXT = 4, 4.0, 10
#: Share of a face's readings at one end from which that is its level without light.
_UNLIT = 0.25
#: Rows with one reading to be no reading, and their directions' extent over the field's.
_STUCK, _STUCK_EXTENT = 3, 0.1


@dataclass(frozen=True)
class Level:
    """Values of a column between which readings lie; at and beyond them there is none."""

    low: float = -np.inf
    high: float = np.inf


@dataclass
class BadCells:
    """What was found in a file's cells."""

    excluded: list[Excluded] = field(default_factory=list)  # rows left out, with the cause
    levels: dict[str, Level] = field(default_factory=dict)  # by column of readings
    notes: list[str] = field(default_factory=list)  # a sentence for each such value


def without_bad_cells(table: Table, settings: Settings) -> tuple[Table, BadCells]:
    """Return a table whose cells that hold no reading or direction are NaN, and what was found.

    TableError if a column is missing or holds no numbers.
    """
    found = BadCells()
    columns = {name: np.array(column) for name, column in table.columns.items()}
    cause = np.full(len(table), "", dtype=object)
    for name in settings.readings.columns:
        values = table.numbers(name).copy()
        _of_readings(name, values, settings, found, cause)
        columns[name] = values
    _shared_levels(columns, settings, found, cause)
    for name, unit in zip(settings.direction.columns, settings.direction.units, strict=True):
        values = table.numbers(name).copy()
        _of_directions(name, values, settings, DEGREES[unit], cause)
        columns[name] = values
    cleaned = replace(table, columns=columns)
    for reason, bad in _repeated(cleaned, settings):
        new = bad & (cause == "")
        cause[new] = reason
        for name in settings.readings.columns:
            columns[name] = np.where(new, np.nan, columns[name])
    run, names = runs_of(table, settings)
    found.excluded = [
        Excluded(names[run[at]], int(at) + table.first_row, str(cause[at]))
        for at in np.flatnonzero(cause != "")
    ]
    return replace(table, columns=columns), found


def _of_readings(
    name: str, values: Floats, settings: Settings, found: BadCells, cause: NDArray[np.object_]
) -> None:
    """Blank sentinels and clipped values of a column of readings, in place."""
    level = found.levels.get(name, Level())
    for value in _sentinels(values, _FAR_OFF):
        level = _narrowed(level, value, float(np.nanmedian(values)))
        _blank(values, values == value, f"sentinel {value:g} in {name}", found, cause)
    for value, word in _clipped(values, settings):
        level = _narrowed(level, value, float(np.nanmedian(values)))
        _blank(values, values == value, f"{word} at {value:.6g} in {name}", found, cause)
    found.levels[name] = level


def _shared_levels(
    columns: dict[str, NDArray[np.generic]],
    settings: Settings,
    found: BadCells,
    cause: NDArray[np.object_],
) -> None:
    """Blank values at the level at which another column is cut off: one converter reads all."""
    highs = {level.high for level in found.levels.values() if np.isfinite(level.high)}
    for name in settings.readings.columns:
        values = np.asarray(columns[name], dtype=np.float64)
        for high in highs:
            if np.isfinite(values).any() and np.nanmax(values) == high:
                found.levels[name] = _narrowed(found.levels[name], high, -np.inf)
                _blank(values, values == high, f"cut off at {high:.6g} in {name}", found, cause)
        columns[name] = values


def _blank(
    values: Floats, bad: NDArray[np.bool_], reason: str, found: BadCells,
    cause: NDArray[np.object_],
) -> None:  # fmt: skip
    found.notes.append(f"{int(bad.sum())} rows: {reason}")
    cause[bad & (cause == "")] = reason
    values[bad] = np.nan


def _narrowed(level: Level, value: float, middle: float) -> Level:
    if value > middle:
        return Level(level.low, min(level.high, value))
    return Level(max(level.low, value), level.high)


def _sentinels(values: Floats, far_off: float) -> Iterator[float]:
    """Yield values that stand many times far from all others."""
    rest = np.sort(values[np.isfinite(values)])
    while len(np.unique(rest)) > _FEWEST_VALUES:
        for value, others in ((rest[0], rest[rest != rest[0]]), (rest[-1], rest[rest != rest[-1]])):
            low, high = np.percentile(others, [1, 99])
            gap = max(others[0] - value, value - others[-1])
            if len(rest) - len(others) >= _REPEATED and gap > far_off * max(high - low, 1e-300):
                yield float(value)
                rest = others
                break
        else:
            return


def _clipped(values: Floats, settings: Settings) -> Iterator[tuple[float, str]]:
    """Yield the value at an end of a column at which it is cut off, with a word for it."""
    unique, count = np.unique(values[np.isfinite(values)], return_counts=True)
    if len(unique) <= _FEWEST_VALUES:
        return
    for end, beside in ((-1, count[-1 - _NEXT : -1]), (0, count[1 : 1 + _NEXT])):
        value = float(unique[end])
        if count[end] < max(_CLIPPED, _OVER_NEXT * int(beside.max())):
            continue
        word = _word(value, end == -1, settings)
        if settings.readings.kind == "channels" and count[end] > _UNLIT * count.sum():
            continue  # the level of a face without light, of readings that fall
        if word:
            yield value, word


def _word(value: float, at_top: bool, settings: Settings) -> str:
    """Return what a cut-off end of a column is, empty where it is the level without light."""
    stated = settings.readings
    if stated.kind in ("spot", "balance", "frames"):
        return "clipped"
    if at_top != stated.inverted:
        return "saturated"
    # faces without light read one value, and a quadrant without light may
    dark = np.atleast_1d(np.asarray(stated.dark, dtype=np.float64))
    unlit = stated.kind == "channels" or value == 0 or value in dark
    return "" if unlit else "clipped"


def _of_directions(
    name: str, values: Floats, settings: Settings, degrees: float, cause: NDArray[np.object_]
) -> None:
    """Blank sentinels and angles beyond a circle of a column of directions, in place."""
    for value in _sentinels(values, _FAR_OFF_ANGLE):
        bad = values == value
        cause[bad & (cause == "")] = f"sentinel {value:g} in {name}"
        values[bad] = np.nan
    if settings.direction.form not in ("vector", "quaternion", "matrix"):
        bad = np.abs(values) * degrees > 360.0 * (1.0 + 1e-9)
        cause[bad & (cause == "")] = f"angle beyond a circle in {name}"
        values[bad] = np.nan


def _repeated(table: Table, settings: Settings) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """Yield rows that repeat another, and readings that stand for directions far apart."""
    readings = np.column_stack([table.numbers(name) for name in settings.readings.columns])
    stated = np.column_stack([table.numbers(name) for name in settings.direction.columns])
    whole = np.asarray(np.isfinite(readings).all(axis=1) & np.isfinite(stated).all(axis=1))
    at = np.flatnonzero(whole)
    if len(at) < _FEWEST_VALUES:
        return
    first = np.unique(np.column_stack([readings, stated])[at], axis=0, return_index=True)[1]
    again = np.zeros(len(whole), dtype=np.bool_)
    again[np.delete(at, first)] = True
    yield DUPLICATE, again
    at = at[np.sort(first)]
    sun = directions_of(stated, table, settings)[0][at]
    _, group, count = np.unique(readings[at], axis=0, return_inverse=True, return_counts=True)
    field = float(np.linalg.norm(np.nanstd(sun, axis=0)))
    stuck = np.zeros(len(whole), dtype=np.bool_)
    for number in np.flatnonzero(count >= _STUCK):
        members = np.flatnonzero(group.reshape(-1) == number)
        lit = (readings[at[members[0]]] != 0).any()
        if lit and np.linalg.norm(np.nanstd(sun[members], axis=0)) > _STUCK_EXTENT * field:
            stuck[at[members]] = True
    yield "reading that repeats for directions far apart", stuck


def joined_levels(parts: list[BadCells]) -> Mapping[str, Level]:
    """Return the narrowest levels of several files, by column."""
    found: dict[str, Level] = {}
    for part in parts:
        for name, level in part.levels.items():
            known = found.get(name, Level())
            found[name] = Level(max(known.low, level.low), min(known.high, level.high))
    return found


#: Most light that is answered, in units of the most that was measured.
_MORE_LIGHT = 2.0


@dataclass(frozen=True)
class ReadingLimits:
    """Readings between these limits, the limits themselves excluded, may be used.

    `low` and `high` stand by column of readings, in the file's own units: levels at which readings
    were found to be sentinels, saturated or clipped; infinite where none was found. The light is
    the sum of the readings less dark over gain: from a tenth of the usual, below which rows are
    left out, to twice the most that was measured; 0 and infinity where readings measure none.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    least_light: float
    most_light: float


def limits_of(readings: Readings, settings: Settings, levels: Mapping[str, Level]) -> ReadingLimits:
    """Return the limits of readings that were fitted, by the levels of columns such as -999."""
    known = [levels.get(name, Level()) for name in settings.readings.columns]
    least, most = 0.0, np.inf
    if settings.readings.kind in ("quadrants", "electrodes", "channels"):
        total = readings.raw.sum(axis=1)
        least = FAINT * float(np.percentile(total, 95))
        most = _MORE_LIGHT * float(total.max())
    return ReadingLimits(
        tuple(one.low for one in known), tuple(one.high for one in known), max(least, 0.0), most
    )
