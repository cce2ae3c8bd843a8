"""Readings and directions of a calibration file, row by row, after its settings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import sun_from_angles, sun_from_rotations
from algorithms.contract import FeatureKind, Floats
from calibrate.forms.attitudes import rotated, sun_by_date
from calibrate.forms.units import DEGREES, KELVIN, SECONDS, TimeUnit
from calibrate.settings import (
    AngleForm,
    DirectionSettings,
    ReadingsSettings,
    RowSettings,
    Settings,
    Transform,
)
from calibrate.table import Table, TableError

#: What each transform does to the two features of a row, as a matrix.
MATRICES: dict[Transform, tuple[tuple[float, float], tuple[float, float]]] = {
    "swap-xy": ((0.0, 1.0), (1.0, 0.0)),
    "mirror-x": ((-1.0, 0.0), (0.0, 1.0)),
    "mirror-y": ((1.0, 0.0), (0.0, -1.0)),
    "rotate-90": ((0.0, -1.0), (1.0, 0.0)),
    "rotate-180": ((-1.0, 0.0), (0.0, -1.0)),
    "rotate-270": ((0.0, 1.0), (-1.0, 0.0)),
    "swap-negated-xy": ((0.0, -1.0), (-1.0, 0.0)),
}
#: Why rows of a sensor that looks one way are left out.
BEHIND = "the light is behind the sensor"
FALLING = "readings fall when light rises"
NO_SUM = "the signals have no positive sum"
EMPTY = "a cell is empty or not a finite number"
FAINT_ROWS = "there is hardly any light"
#: Cosine of the angle off the axis up to which the light is along the detector's plane.
GRAZING = 1e-6
#: Share of the usual light below which balances are those of noise.
FAINT = 0.1
_KINDS = {"spot": FeatureKind.SPOT, "channels": FeatureKind.SIGNALS}


@dataclass(frozen=True)
class Readings:
    """Samples of a calibration."""

    features: Floats  # (N, F), spots, balances or signals
    sun: Floats  # (N, 3), unit vectors to the light
    kind: FeatureKind
    rows: NDArray[np.int64]  # (N,), in the file
    run: NDArray[np.int64]  # (N,), from 0
    run_names: tuple[str, ...]
    raw: Floats  # (N, K), less dark over gain, before balances are made
    context: Mapping[str, Floats] = field(default_factory=dict)  # of time_s and temperature_K
    angles: Floats | None = None  # (N, 2), the file's, degrees
    dropped: Mapping[str, int] = field(default_factory=dict)  # rows left out of the file, by reason

    def __len__(self) -> int:
        return len(self.rows)

    def only(self, kept: NDArray[np.bool_] | NDArray[np.int64]) -> Readings:
        """Return the samples that a mask or places select."""
        return replace(
            self,
            features=self.features[kept],
            sun=self.sun[kept],
            rows=self.rows[kept],
            run=self.run[kept],
            raw=self.raw[kept],
            context={name: column[kept] for name, column in self.context.items()},
            angles=None if self.angles is None else self.angles[kept],
        )

    def thinned(self, most: int) -> Readings:
        """Return at most so many samples, evenly."""
        step = max(-(-len(self) // most), 1)
        return self if step == 1 else self.only(np.arange(0, len(self), step))


def readings_of(table: Table, settings: Settings, *, behind: bool = False) -> Readings:
    """Return the samples of a table by settings of its columns.

    Rows without a finite reading and direction, of zeros alone, or whose light's direction is no
    vector are left out and counted by reason; so are those with the light behind the sensor, unless
    `behind`. TableError if a column is missing or holds no numbers, or no row is left.
    """
    raw = np.column_stack([table.numbers(name) for name in settings.readings.columns])
    stated = np.column_stack([table.numbers(name) for name in settings.direction.columns])
    sun, angles = directions_of(stated, table, settings)
    signals = _signals(raw, settings.readings)
    features = features_of_signals(signals, settings)
    run, names = runs_of(table, settings)
    context = _context(table, settings)
    rows = table.rows
    if settings.rows.shift:
        kept, other = _shifted(run, settings.rows.shift)
        features, signals, raw = features[other], signals[other], raw[other]
        sun, stated, rows, run = sun[kept], stated[kept], rows[kept], run[kept]
        angles = None if angles is None else angles[kept]
        context = {name: column[kept] for name, column in context.items()}
    reasons = _reasons(raw, signals, stated, sun, features, settings)
    if behind:
        reasons.pop(BEHIND, None)
    for name, column in context.items():
        reasons[f"{name} is not a number"] = ~np.isfinite(column)
    usable, dropped = np.ones(len(rows), dtype=np.bool_), Counter[str]()
    for reason, bad in reasons.items():
        dropped[reason] += int((bad & usable).sum())
        usable &= ~bad
    if not usable.any():
        counts = ", ".join(f"{count} {reason}" for reason, count in dropped.items() if count)
        # Readings that fall when light rises have negative sums where nothing is taken off them.
        falling = dropped[NO_SUM] and np.nanmedian(raw.sum(axis=1)) < 0
        hint = f"; {FALLING}: say inverted = true" if falling else ""
        raise TableError(f"{table.source}: no row can be used ({counts}){hint}")
    made = Readings(
        features, sun, _KINDS.get(settings.readings.kind, FeatureKind.BALANCE), rows, run, names,
        signals, context, angles, {reason: count for reason, count in dropped.items() if count},
    )  # fmt: skip
    return made.only(usable)


def features_of(raw: Floats, settings: Settings) -> Floats:
    """Return features (N, F) of readings (N, K) as they stand in a file's columns."""
    signals = _signals(np.asarray(raw, dtype=np.float64), settings.readings)
    return features_of_signals(signals, settings)


def features_of_signals(signals: Floats, settings: Settings) -> Floats:
    """Return features (N, F) of signals (N, K): readings less dark over gain."""
    return _turned(_features(signals, settings.readings), settings)


def directions_of(stated: Floats, table: Table, settings: Settings) -> tuple[Floats, Floats | None]:
    """Return unit vectors (N, 3) of a file's columns, and its two angles in degrees if any."""
    direction = settings.direction
    if direction.form in ("quaternion", "matrix"):
        light = _light(table, direction, settings.rows)
        scalar_first = direction.scalar == "first"
        to_sensor = direction.attitude == "to-sensor"
        sun = rotated(stated, light, scalar_first=scalar_first, to_sensor=to_sensor)
        return (-sun if direction.from_light else sun), None
    return directions(stated, direction)


def _light(table: Table, direction: DirectionSettings, rows: RowSettings) -> Floats:
    """Return the light's direction (N, 3) in the outer frame of an attitude."""
    if direction.light_by_date is not None:
        unit = rows.time_unit if direction.light_by_date == rows.time_s else "s"
        return sun_by_date(_seconds(table.numbers(direction.light_by_date), unit))
    if direction.light_columns is not None:
        return np.column_stack([table.numbers(name) for name in direction.light_columns])
    return np.broadcast_to(np.asarray(direction.light), (len(table), 3))


def _seconds(time: Floats, unit: TimeUnit) -> Floats:
    scale, zero = SECONDS[unit]
    return np.asarray(scale * (time - zero))


def directions(columns: Floats, settings: DirectionSettings) -> tuple[Floats, Floats | None]:
    """Return unit vectors (N, 3) of vectors or angles, and two angles in degrees if any."""
    if settings.form == "vector":
        length = np.linalg.norm(columns, axis=1)
        near = (length > 0.5) & (length < 2.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            sun = columns / length[:, None]
        sun[~near] = np.nan
        return (-sun if settings.from_light else sun), None
    angles = columns * [DEGREES[unit] for unit in settings.units]
    if settings.form == "one-angle":
        angle = np.radians(angles[:, 0])
        return np.column_stack([np.sin(angle), np.zeros(len(angle)), np.cos(angle)]), None
    return sun_of_angles(angles, cast("AngleForm", settings.form)), angles


def sun_of_angles(angles_deg: Floats, form: AngleForm) -> Floats:
    """Return unit vectors (N, 3) of two angles (N, 2), degrees, of one of the forms."""
    if form == "projection":
        return sun_from_angles(angles_deg)
    if form in ("alpha-inner", "beta-inner"):
        return sun_from_rotations(angles_deg, inner="alpha" if form == "alpha-inner" else "beta")
    azimuth, other = np.radians(angles_deg).T
    off = np.pi / 2 - other if form == "azimuth-elevation" else other
    return np.column_stack(
        [np.sin(off) * np.cos(azimuth), np.sin(off) * np.sin(azimuth), np.cos(off)]
    )


def _signals(raw: Floats, settings: ReadingsSettings) -> Floats:
    return np.asarray(settings.sign * (raw - np.asarray(settings.dark)) / np.asarray(settings.gain))


def raw_of(signals: Floats, settings: ReadingsSettings) -> Floats:
    """Return readings (N, K) as a file's columns have them of signals: less dark over gain."""
    return np.asarray(
        np.asarray(settings.dark) + settings.sign * np.asarray(settings.gain) * signals
    )


def _turned(features: Floats, settings: Settings) -> Floats:
    for transform in settings.apply:
        if features.shape[1] == 2:
            features = features @ np.asarray(MATRICES[transform]).T
    return features


def _features(signals: Floats, settings: ReadingsSettings) -> Floats:
    if settings.kind == "quadrants":
        return quadrant_balances(signals)
    if settings.kind == "electrodes":
        halves = signals.reshape(-1, 2, 2)
        with np.errstate(invalid="ignore", divide="ignore"):
            balances = (halves[:, :, 0] - halves[:, :, 1]) / halves.sum(axis=2)
        balances[~(halves.sum(axis=2) > 0)] = np.nan
        return np.asarray(balances)
    if settings.kind == "pair":
        total = signals.sum(axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            balance = (signals[:, 0] - signals[:, 1]) / total
        return np.column_stack([np.where(total > 0, balance, np.nan), np.zeros(len(total))])
    if signals.shape[1] == 1:  # of a sensor of one axis
        return np.column_stack([signals, np.zeros(len(signals))])
    return signals


def quadrant_balances(signals: Floats) -> Floats:
    """Return balances (N, 2) of quadrants (N, 4) at (-x, +y), (+x, +y), (+x, -y), (-x, -y)."""
    first, second, third, fourth = signals.T
    total = signals.sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        balances = np.column_stack(
            [(second + third - first - fourth) / total, (first + second - third - fourth) / total]
        )
    balances[~(total > 0)] = np.nan
    return balances


def _reasons(  # noqa: PLR0917 - what a row is made of
    raw: Floats, signals: Floats, stated: Floats, sun: Floats, features: Floats, settings: Settings
) -> dict[str, NDArray[np.bool_]]:
    # a single reading may well be zero
    zeros = (raw == 0).all(axis=1) & (raw.shape[1] > 1)
    faint = np.zeros(len(raw), dtype=np.bool_)
    if settings.readings.kind in ("quadrants", "electrodes", "pair"):
        total = signals.sum(axis=1)
        usual = np.nanpercentile(total, 95) if np.isfinite(total).any() else np.nan
        faint = (usual > 0) & (total > 0) & (total < FAINT * usual)
    if settings.direction.form == "vector":
        zeros |= (stated == 0).all(axis=1)
    found = {
        EMPTY: ~(np.isfinite(raw).all(axis=1) & np.isfinite(stated).all(axis=1)),
        "all readings, or the direction, are zero": zeros,
        "the direction is no unit vector, or 90 deg or more off": ~np.isfinite(sun).all(axis=1),
        FAINT_ROWS: faint,
        NO_SUM: ~np.isfinite(features).all(axis=1),
    }
    if settings.readings.kind != "channels":
        found[BEHIND] = ~(sun[:, 2] > GRAZING)
    return found


def runs_of(table: Table, settings: Settings) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    """Return the run (N,) of each row of a table, from 0, and the names of the runs."""
    if settings.rows.run is None:
        return np.zeros(len(table), dtype=np.int64), (table.source,)
    if settings.rows.run not in table.columns:
        table.numbers(settings.rows.run)
    column = np.asarray(table.columns[settings.rows.run])
    names, run = np.unique(column.astype(str), return_inverse=True)
    return run.reshape(-1).astype(np.int64), tuple(str(name) for name in names)


def _context(table: Table, settings: Settings) -> dict[str, Floats]:
    rows, found = settings.rows, {}
    if rows.time_s is not None:
        found["time_s"] = _seconds(table.numbers(rows.time_s), rows.time_unit)
    if rows.temperature_K is not None:
        scale, offset = KELVIN[rows.temperature_unit]
        found["temperature_K"] = scale * table.numbers(rows.temperature_K) + offset
    return found


def _shifted(run: NDArray[np.int64], shift: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Places of poses and of their readings, `shift` rows later in the same run."""
    pose = np.arange(len(run))
    reading = pose + shift
    inside = (reading >= 0) & (reading < len(run))
    pose, reading = pose[inside], reading[inside]
    same = run[pose] == run[reading]
    return pose[same], reading[same]


def joined(parts: Sequence[Readings]) -> Readings:
    """Return the samples of several files, each file's runs apart from the others'."""
    first = parts[0]
    run: list[NDArray[np.int64]] = []
    names: list[str] = []
    for part in parts:
        run.append(part.run + len(names))
        names += part.run_names
    dropped = Counter[str]()
    for part in parts:
        dropped.update(part.dropped)
    shared = set.intersection(*(set(part.context) for part in parts))
    return Readings(
        np.vstack([part.features for part in parts]),
        np.vstack([part.sun for part in parts]),
        first.kind,
        np.concatenate([part.rows for part in parts]),
        np.concatenate(run),
        tuple(names),
        np.vstack([part.raw for part in parts]),
        {name: np.concatenate([part.context[name] for part in parts]) for name in sorted(shared)},
        np.vstack([a for part in parts if (a := part.angles) is not None])
        if first.angles is not None
        else None,
        dict(dropped),
    )
