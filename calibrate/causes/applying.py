"""Files read under settings, and findings applied one by one until none that is certain is left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from algorithms.contract import UnusableDataError
from calibrate.causes.bad_cells import BadCells, without_bad_cells
from calibrate.conventions.channels import of_cells
from calibrate.conventions.finding import Finding, change_of
from calibrate.conventions.findings import findings
from calibrate.readings import BEHIND, EMPTY, Readings, joined, readings_of
from calibrate.settings import Settings
from calibrate.table import Table, TableError

#: Directions that lie this near to one plane through the sensor are those of one axis.
_ONE_AXIS = 0.02
#: Share of rows with the light behind the sensor from which the angles' own form is uncertain.
_MANY_BEHIND = 0.05


@dataclass(frozen=True)
class File:
    """Samples of all tables under some settings, and what their conventions seem to be."""

    settings: Settings
    readings: Readings
    findings: list[Finding]
    bad: list[BadCells]


def read_as(tables: Sequence[Table], settings: Settings) -> File:
    """Read all tables, without cells that hold no reading."""
    cleaned = [without_bad_cells(table, settings) for table in tables]
    bad = [found for _, found in cleaned]
    readings = joined([readings_of(table, settings) for table, _ in cleaned])
    dropped = {**readings.dropped}
    dropped[EMPTY] = dropped.get(EMPTY, 0) - sum(len(one.excluded) for one in bad)
    readings = replace(readings, dropped={name: n for name, n in dropped.items() if n > 0})
    if one_plane(readings):
        return File(settings, readings, [], bad)
    every = None
    if readings.dropped.get(BEHIND, 0) > _MANY_BEHIND * len(readings):
        every = joined([readings_of(table, settings, behind=True) for table, _ in cleaned])
    return File(settings, readings, findings(readings, settings, every), bad)


def with_cells(tables: Sequence[Table], guessed: Settings) -> Settings:
    """Return settings guessed from names, with channels where four readings are plain cells."""
    if guessed.readings.kind != "quadrants":
        return guessed
    readings = joined([readings_of(table, guessed) for table in tables])
    change = next(of_cells(readings, guessed), None)
    return guessed if change is None else change_of(guessed, change)


def applied_to(tables: Sequence[Table], file: File, notes: list[str]) -> tuple[File, list[Finding]]:
    """Apply certain findings one by one, judging all again after each, until none is left.

    A finding about what was changed already, or that leads back to settings that were left,
    contradicts what was applied: it stays, so that the verdict is not good.
    """
    applied: list[Finding] = []
    seen = [file.settings]
    while certain := next((one for one in file.findings if one.certain and one.change), None):
        changed = change_of(file.settings, certain)
        if changed in seen or certain.about in {one.about for one in applied}:
            notes.append(
                f"changes did not settle: after {'; '.join(one.found for one in applied)}, "
                f"{certain.found}"
            )
            break
        try:
            file = read_as(tables, changed)
        except (TableError, UnusableDataError) as error:
            notes.append(f"{certain.found}: not applied, since then {error}")
            break
        applied.append(certain)
        seen.append(changed)
    return file, applied


def one_plane(readings: Readings) -> bool:
    """Say whether the poses lie in one plane through the sensor; UnusableDataError below three."""
    if len(readings) < 3:
        raise UnusableDataError(f"expected three poses or more; got {len(readings)}")
    size = np.linalg.svd(readings.sun, compute_uv=False)
    return bool(size[2] < _ONE_AXIS * size[1])
