"""Comparison with a factory's calibration: a table of readings and directions, or a JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from algorithms.angles import separation_deg
from algorithms.contract import Floats
from algorithms.discovery import discover_chains
from calibrate.calibration import Calibration
from calibrate.documents import load
from calibrate.readings import joined, readings_of
from calibrate.report.errors import Errors, level
from calibrate.roles import understood
from calibrate.selection import applicable, fitted
from calibrate.settings import RowSettings, Settings
from calibrate.table import Table, TableError, read_table


@dataclass(frozen=True)
class Compared:
    """Errors of a factory's calibration and of this one, left out, on the same rows."""

    name: str  # of the file, and how it was read
    samples: int  # rows that both answer
    unanswered: int  # rows that the factory's does not answer
    rms_deg: tuple[float, float]  # of the factory's, and of this one
    level95_deg: tuple[float, float]
    largest_deg: tuple[float, float]
    turned_rms_deg: float  # after the rotation that fits best, as of another mount


def compared_with(path: Path, found: Calibration, tables: Sequence[Table]) -> Compared:
    """Compare a calibration with a factory's: a saved JSON, or a table, which is interpolated.

    `tables` are those that it was calibrated on. TableError if no row is answered by both;
    UnreadableCalibrationError if the JSON is no calibration.
    """
    if path.suffix.lower() == ".json":
        sun, said = _of_document(path, found, tables), "a saved calibration"
    else:
        sun, model = _of_table(path, found)
        said = f"a table, interpolated by {model}"
    errors = Errors.of(found)
    step = max(-(-len(found.readings) // max(len(errors.readings), 1)), 1)
    sun = sun[::step]
    theirs = separation_deg(sun, errors.readings.sun)
    both = np.isfinite(theirs) & errors.known
    if not both.any():
        raise TableError(f"{path.name}: answers none of the {len(both)} rows left out")
    one, other = theirs[both], errors.errors_deg[both]
    return Compared(
        f"{path.name} ({said})",
        int(both.sum()),
        int((~np.isfinite(theirs)).sum()),
        (_rms(one), _rms(other)),
        (level(one, 0.95), level(other, 0.95)),
        (float(one.max()), float(other.max())),
        _turned(sun[both], errors.readings.sun[both]),
    )


def _rms(errors: Floats) -> float:
    return float(np.sqrt(np.mean(errors**2)))


def _of_document(path: Path, found: Calibration, tables: Sequence[Table]) -> Floats:
    """Return the directions (N, 3) of a saved calibration at the rows of another; NaN of none."""
    saved = load(path)
    if (saved.settings.readings, saved.settings.apply) == (
        found.settings.readings,
        found.settings.apply,
    ):
        return saved.predict(found.readings.features, found.readings.context)
    stated = found.settings.model_copy(
        update={"readings": saved.settings.readings, "apply": saved.settings.apply}
    )
    read = joined([readings_of(table, stated) for table in tables])
    place = {
        key: at for at, key in enumerate(zip(read.run.tolist(), read.rows.tolist(), strict=True))
    }
    sun = np.full((len(found.readings), 3), np.nan)
    used = found.readings
    keys = zip(used.run.tolist(), used.rows.tolist(), strict=True)
    pairs = np.array([(at, place[key]) for at, key in enumerate(keys) if key in place], dtype=int)
    if len(pairs):
        part = read.only(pairs[:, 1])
        sun[pairs[:, 0]] = saved.predict(part.features, part.context)
    return sun


def _of_table(path: Path, found: Calibration) -> tuple[Floats, str]:
    """Return the directions (N, 3) of a factory's table at the rows of a calibration."""
    table = read_table(path)
    stated = _settings_of(table, found.settings)
    theirs = readings_of(table, stated)
    if theirs.kind is not found.readings.kind:
        raise TableError(f"{path.name}: expected readings of kind {found.readings.kind.name}")
    known = applicable(theirs, found.geometry)
    name = "lut" if "lut" in known else found.chosen.name
    model = fitted(known.get(name) or discover_chains()[name], theirs, found.geometry)
    return np.asarray(model.predict(found.readings.features, found.readings.context)), name


def _settings_of(table: Table, settings: Settings) -> Settings:
    wanted = {*settings.readings.columns, *settings.direction.columns}
    if not wanted <= set(table.columns):
        return understood(table).settings.model_copy(update={"rows": RowSettings()})
    return settings.model_copy(update={"rows": RowSettings()})


def _turned(predicted: Floats, sun: Floats) -> float:
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 - SciPy, at the first use

    turn, _ = Rotation.align_vectors(sun, predicted)
    return _rms(separation_deg(turn.apply(predicted), sun))
