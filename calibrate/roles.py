"""Guessing what columns are from their names, units and values; the reader can correct it."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Any, cast, get_args

import numpy as np

from algorithms.contract import FeatureKind, Floats
from calibrate.causes.applying import with_cells
from calibrate.conventions.findings import left_deg
from calibrate.forms import names as words
from calibrate.forms.attitudes import are_matrices, are_quaternions
from calibrate.forms.units import AngleUnit, TemperatureUnit, TimeUnit, is_angle, named
from calibrate.readings import Readings, readings_of
from calibrate.robust import robust_map
from calibrate.settings import (
    DirectionSettings,
    Kind,
    ReadingsSettings,
    RowSettings,
    SensorSettings,
    Settings,
)
from calibrate.table import Table, TableError

#: Median of a temperature below which it is taken for degrees Celsius where no unit is said.
_COLDEST_K = 150.0
#: Sizes of seconds since 1970 in other units: from so many on.
_EPOCHS: tuple[tuple[float, TimeUnit], ...] = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"))
#: Largest size of a balance, noise included.
_BALANCE = 1.2


@dataclass(frozen=True)
class Understood:
    """What the columns of a table seem to be."""

    settings: Settings
    notes: tuple[str, ...] = ()  # what the names alone do not say, without an end


@dataclass
class _Columns:
    """Columns of a table that nothing is known of yet."""

    table: Table
    keys: dict[str, str]
    units: dict[str, str]
    rest: list[str]
    notes: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, table: Table) -> _Columns:
        keys, units = {}, dict(table.units)
        for name in table.columns:
            read = named(name)
            if read.unit is not None:
                units.setdefault(name, read.unit)
            keys[name] = f"{read.bare}_deg" if is_angle(units.get(name)) else read.bare
        return cls(table, keys, units, list(table.columns))

    def take(self, *columns: str | None) -> None:
        self.rest = [name for name in self.rest if name not in columns]

    def match(self, pattern: str) -> str | None:
        return words.match(pattern, self.keys, self.rest)

    def match_all(self, patterns: Sequence[str]) -> tuple[str, ...]:
        return words.match_all(patterns, self.keys, self.rest)

    def readable(self, name: str) -> bool:
        return name not in self.table.unread

    def angle(self, name: str) -> bool:
        return is_angle(self.units.get(name))

    def values(self, columns: Sequence[str]) -> np.ndarray[Any, Any]:
        return np.column_stack([self.table.numbers(name) for name in columns])


def guess(table: Table) -> Settings:
    """Return settings guessed from a table's columns; TableError where none fit."""
    return understood(table).settings


def understood(table: Table) -> Understood:
    """Return settings guessed from a table's columns, and how.

    TableError if no columns of the light's direction or of readings are recognised: the message
    says what to write into a config.
    """
    columns = _Columns.of(table)
    rows = _rows_of(columns)
    ways = _directions_of(columns)
    if not ways:
        raise TableError(_no_direction(columns))
    for name in {name for way in ways for name in _used(way)}:
        columns.take(name)
    one_axis = ways[0].form == "one-angle"
    readings, normals = _readings_of(columns, one_axis=one_axis)
    if readings is None:
        raise TableError(_no_readings(columns, ways[0]))
    made = [
        Settings(
            readings=readings, direction=way, rows=rows, sensor=SensorSettings(face_normals=normals)
        )
        for way in ways
    ]
    settings = made[0]
    if len(made) > 1:
        settings, said = best_of(table, made)
        columns.notes.append(said)
    settings = _turned(table, settings, columns.notes)
    settings = _as_cells(table, settings, columns.notes)
    return Understood(settings, tuple(columns.notes))


def _rows_of(columns: _Columns) -> RowSettings:
    """Take run, time, temperature and indices off the columns."""
    run = columns.match(words.RUN)
    temperature = next(
        (
            name
            for name in columns.rest
            if columns.readable(name)
            and re.fullmatch(words.TEMPERATURE, columns.keys[name])
            and (columns.keys[name] != "t" or columns.units.get(name) in get_args(TemperatureUnit))
        ),
        None,
    )
    columns.take(run, temperature)
    times = [n for n in columns.rest if re.fullmatch(words.TIME, columns.keys[n])]
    times = [name for name in times if not columns.angle(name)]
    dated = [name for name in times if columns.units.get(name) == "unix"]
    readable = [*dated, *(name for name in times if columns.readable(name))]
    columns.notes += [
        f"column {name} is neither a number nor a date and is not used"
        for name in times
        if not columns.readable(name)
    ]
    columns.take(*times)
    columns.take(
        *(name for name in columns.rest if re.fullmatch(words.INDEX, columns.keys[name])
          and _counts(columns, name))
    )  # fmt: skip
    said: dict[str, Any] = {"run": run}
    if readable:
        said |= {"time_s": readable[0], "time_unit": _time_unit(columns, readable[0])}
    if temperature:
        said |= {
            "temperature_K": temperature,
            "temperature_unit": _temperature_unit(columns, temperature),
        }
    return RowSettings(**said)


def _counts(columns: _Columns, name: str) -> bool:
    """Say whether a column counts rows."""
    if not columns.readable(name):
        return False
    values = columns.table.numbers(name)
    return len(values) > 1 and bool((np.diff(values) == 1.0).all())


def _time_unit(columns: _Columns, name: str) -> TimeUnit:
    unit = columns.units.get(name)
    if unit in get_args(TimeUnit):
        return unit  # type: ignore[return-value]  # narrowed by what it is one of
    if unit == "unix":
        return "s"
    for word in ("mjd", "jd", "julian"):
        if columns.keys[name].startswith(word):
            return "mjd" if word == "mjd" else "jd"
    size = _median(columns, name)
    for least, epoch in _EPOCHS:
        if size > least:
            columns.notes.append(f"column {name} is taken as {epoch} since 1970 by its size")
            return epoch
    return "s"


def _median(columns: _Columns, name: str) -> float:
    values = columns.table.numbers(name)
    known = np.abs(values[np.isfinite(values)])
    return float(np.median(known)) if len(known) else 0.0


def _temperature_unit(columns: _Columns, name: str) -> TemperatureUnit:
    unit = columns.units.get(name)
    if unit in get_args(TemperatureUnit):
        return unit  # type: ignore[return-value]  # narrowed by what it is one of
    if _median(columns, name) > _COLDEST_K:
        return "K"
    columns.notes.append(f"column {name} is taken as degrees Celsius by its size")
    return "degC"


def _directions_of(columns: _Columns) -> list[DirectionSettings]:
    """Return the ways in which columns may say the direction; several only for attitudes."""
    vector = columns.match_all(words.VECTOR)
    ways = [*_attitudes(columns, vector)]
    if vector:
        ways.append(DirectionSettings(columns=vector, form="vector"))
    if ways:
        return ways
    rays = columns.match_all(words.FROM_LIGHT)
    if rays:
        columns.notes.append("the vectors' names say that they point from the light")
        return [DirectionSettings(columns=rays, form="vector", from_light=True)]
    form, pair = words.first_of(words.ANGLES, columns.keys, columns.rest)
    if form is not None:
        return [_angles(columns, pair, form)]
    angles = [name for name in columns.rest if columns.angle(name)]
    if len(angles) == 2:
        columns.notes.append(
            f"columns {angles[0]} and {angles[1]}, which hold angles, are taken as rotations about "
            "x and y"
        )
        return [_angles(columns, tuple(angles), "alpha-inner")]
    one = angles[0] if len(angles) == 1 else columns.match(words.ONE_ANGLE)
    return [] if one is None else [_angles(columns, (one,), "one-angle")]


def _angles(columns: _Columns, pair: tuple[str, ...], form: Any) -> DirectionSettings:
    said = [columns.units.get(name) for name in pair]
    units = tuple(cast("AngleUnit", unit if is_angle(unit) else "deg") for unit in said)
    return DirectionSettings(
        columns=pair, form=form, unit=units[0] if len(set(units)) == 1 else units
    )


def _attitudes(columns: _Columns, vector: tuple[str, ...]) -> list[DirectionSettings]:
    """Return every convention of an attitude and of where the light is in its outer frame."""
    found: list[dict[str, Any]] = []
    for patterns in words.QUATERNION:
        if (four := columns.match_all(patterns)) and are_quaternions(columns.values(four)):
            found = [{"columns": four, "form": "quaternion", "scalar": "last"}]
    if not found:
        for patterns in words.NUMBERED:
            four = columns.match_all(patterns)
            if four and all(map(columns.readable, four)) and are_quaternions(columns.values(four)):
                order = ("first", "last") if patterns[0].endswith("0") else ("last", "first")
                found = [
                    {"columns": four, "form": "quaternion", "scalar": place} for place in order
                ]
                break
    if not found:
        for patterns in words.MATRICES:
            nine = columns.match_all(patterns)
            if nine and all(map(columns.readable, nine)) and are_matrices(columns.values(nine)):
                found = [{"columns": nine, "form": "matrix"}]
                break
    if not found:
        return []
    turned = [{**one, "attitude": way} for one, way in product(found, ("to-sensor", "from-sensor"))]
    lights = _lights(columns, vector)
    return [DirectionSettings(**{**one, **light}) for light in lights for one in turned]


def _lights(columns: _Columns, vector: tuple[str, ...]) -> list[dict[str, Any]]:
    outer = columns.match_all(words.OUTER_LIGHT)
    if outer:
        return [{"light_columns": outer}]
    if vector:
        return [{"light_columns": vector}]
    dated = _dated(columns)
    return [{}, *([{"light_by_date": dated}] if dated else [])]


def _dated(columns: _Columns) -> str | None:
    """Return the column of dates, if there is one: its seconds are those since 1970."""
    for name in columns.table.columns:
        if not re.fullmatch(words.TIME, columns.keys[name]) or not columns.readable(name):
            continue
        if columns.units.get(name) == "unix" or _median(columns, name) > 1e8:
            return name
        if columns.keys[name].startswith(("jd", "mjd", "julian")):
            return name
    return None


def _used(way: DirectionSettings) -> tuple[str, ...]:
    return (*way.columns, *(way.light_columns or ()))


def _readings_of(
    columns: _Columns, *, one_axis: bool
) -> tuple[ReadingsSettings | None, tuple[tuple[float, float, float], ...] | None]:
    """Return columns of readings among those that are left, and the normals that names say."""
    among = [name for name in columns.rest if not columns.angle(name)]
    bare = {name: columns.keys[name] for name in among}
    faces = [name for name in among if words.face_normal(bare[name])]
    channels = [name for name in among if re.fullmatch(words.CHANNEL, bare[name])]
    kind, found = words.first_of(words.READINGS, columns.keys, among)
    if len(faces) > 4:
        normals = tuple(n for name in faces if (n := words.face_normal(bare[name])) is not None)
        return ReadingsSettings(kind="channels", columns=tuple(faces)), normals
    if len(channels) > 4 and len(channels) > len(found):
        return ReadingsSettings(kind="channels", columns=tuple(channels)), None
    if kind is not None:
        return ReadingsSettings(kind=kind, columns=found), None
    numeric = [name for name in among if columns.readable(name)]
    if one_axis:
        return _one_axis(columns, numeric), None
    if len(numeric) >= 3:
        columns.notes.append(
            f"columns {', '.join(numeric)} are taken as one reading a photodiode or solar cell each"
        )
        return ReadingsSettings(kind="channels", columns=tuple(numeric)), None
    return None, None


def _one_axis(columns: _Columns, numeric: list[str]) -> ReadingsSettings | None:
    """Return the readings of a sensor of one axis: one, or two photodiodes."""
    for patterns in words.PAIR:
        two = words.match_all(patterns, columns.keys, numeric)
        if len(numeric) == 2 and two:
            return ReadingsSettings(kind="pair", columns=two)
    if len(numeric) != 1:
        return None
    values = columns.table.numbers(numeric[0])
    balance = bool(np.nanmax(np.abs(values), initial=0.0) <= _BALANCE)
    kind: Kind = "balance" if balance else "spot"
    return ReadingsSettings(kind=kind, columns=tuple(numeric))


def _as_cells(table: Table, settings: Settings, notes: list[str]) -> Settings:
    """Return settings with channels where four readings are plain cells, not quadrants."""
    if settings.direction.form == "one-angle" or settings.readings.kind != "quadrants":
        return settings
    try:
        changed = with_cells([table], settings)
    except TableError:  # which is told when the table is read
        return settings
    if changed != settings:
        notes.append(
            "the four readings are linear in the light's direction: they are taken as cells that "
            "look different ways, not as quadrants"
        )
    return changed


def _turned(table: Table, settings: Settings, notes: list[str]) -> Settings:
    """Return settings with vectors that point from the light where the values say so."""
    if settings.direction.form != "vector" or settings.direction.from_light:
        return settings
    if not points_from_light(table, settings):
        return settings
    notes.append("the vectors are taken as pointing from the light to the sensor, by their values")
    direction = settings.direction.model_copy(update={"from_light": True})
    return settings.model_copy(update={"direction": direction})


def _no_direction(columns: _Columns) -> str:
    names = [name for name in columns.rest if columns.readable(name)] or columns.rest
    readings, direction = by_order(names or list(columns.table.columns))
    return (
        f"{columns.table.source}: {_header_note(columns.table)}no columns of the light's direction "
        f"among {', '.join(columns.table.columns)}; expected sun_x, sun_y, sun_z, or alpha, beta, "
        f"or azimuth, elevation, or qx, qy, qz, qw; {config_lines(readings, direction)}"
    )


def _no_readings(columns: _Columns, way: DirectionSettings) -> str:
    kind: Kind = "channels" if len(columns.rest) > 2 else "spot"
    if way.form != "one-angle" and len(columns.rest) < 2:
        said = "there is none to be named"
    else:
        said = config_lines(ReadingsSettings(kind=kind, columns=tuple(columns.rest)), way)
    return (
        f"{columns.table.source}: {_header_note(columns.table)}no columns of readings recognised "
        f"among {', '.join(columns.rest) or 'none'}; {said}"
    )


def _header_note(table: Table) -> str:
    return "" if table.header_row else "expected a header with names of columns, and found none; "


#: Samples that conventions are judged by.
_JUDGED = 2000
#: Error of the best convention over that of the next, up to which it counts as told.
_TOLD = 0.5
#: Share of vectors behind a sensor that looks one way from which they point from the light.
_BEHIND = 0.9


def best_of(table: Table, ways: Sequence[Settings]) -> tuple[Settings, str]:
    """Return the settings under which readings and directions go together best, and a sentence.

    The first are taken where the readings do not tell.
    """
    left = [_left_deg(table, one) for one in ways]
    order = sorted(range(len(ways)), key=lambda at: left[at])
    best, second = order[0], order[1]
    if not left[best] < _TOLD * left[second]:
        best = 0
        return ways[0], (
            f"{_words(ways[0])} is assumed; the readings do not tell it from {len(ways) - 1} other "
            "conventions"
        )
    return ways[best], (
        f"of {len(ways)} conventions the readings follow {_words(ways[best])}: "
        f"{left[best]:.2g} deg, the next {left[second]:.2g} deg"
    )


def _words(settings: Settings) -> str:
    direction = settings.direction
    if direction.form == "vector":
        return f"the vector {', '.join(direction.columns)} as it is"
    light = "a light fixed along z"
    if direction.light_columns:
        light = f"the light along {', '.join(direction.light_columns)}"
    if direction.light_by_date:
        light = f"the Sun at the date of {direction.light_by_date}"
    scalar = f", scalar {direction.scalar}" if direction.form == "quaternion" else ""
    turn = "to" if direction.attitude == "to-sensor" else "from"
    return f"the {direction.form}{scalar}, {turn} the sensor's frame, with {light}"


def _left_deg(table: Table, settings: Settings) -> float:
    """Return what a low-order map from readings leaves of directions, degrees; inf if none fits."""
    try:
        readings = readings_of(table, settings).thinned(_JUDGED)
    except TableError:
        return float("inf")
    if len(readings) < max(20, len(table) // 4 if len(table) <= _JUDGED else 20):
        return float("inf")
    if readings.kind is FeatureKind.SIGNALS:
        return float(np.median(robust_map(readings.features, readings.sun, 2)[1]))
    return left_deg(readings, readings.sun)


def points_from_light(table: Table, settings: Settings) -> bool:
    """Say whether vectors point from the light, by their values.

    Those of a sensor that looks one way lie behind it then; a cell whose name says its normal is
    bright where they point away from it. Of cells without names nothing tells: a calibration to the
    light and one from it are the same but for the sign.
    """
    vectors = np.column_stack([table.numbers(name) for name in settings.direction.columns])
    if settings.readings.kind != "channels":
        known = vectors[np.isfinite(vectors).all(axis=1)]
        return len(known) > 0 and bool(np.mean(known[:, 2] < 0) > _BEHIND)
    normals = settings.sensor.face_normals
    if normals is None or not all(name not in table.unread for name in settings.readings.columns):
        return False
    try:
        readings: Readings = readings_of(table, settings).thinned(_JUDGED)
    except TableError:
        return False
    cosines = readings.sun @ np.asarray(normals).T
    return _follow(readings.features, np.maximum(-cosines, 0.0)) > max(
        0.8, _follow(readings.features, np.maximum(cosines, 0.0)) + 0.3
    )


def _follow(signals: Floats, light: Floats) -> float:
    """Return the smallest correlation of a cell's signal with the light on it."""
    found = [
        float(np.corrcoef(signal, expected)[0, 1])
        for signal, expected in zip(signals.T, light.T, strict=True)
        if np.std(signal) > 0 and np.std(expected) > 0
    ]
    return min(found, default=0.0)


def by_order(names: Sequence[str]) -> tuple[ReadingsSettings, DirectionSettings]:
    """Return settings of columns by their order: the last two are angles, those before readings."""
    if len(names) < 4:
        return (
            ReadingsSettings(kind="spot", columns=tuple(names[:1])),
            DirectionSettings(columns=tuple(names[-1:]), form="one-angle"),
        )
    readings = tuple(names[:-2])
    return (
        ReadingsSettings(kind="spot" if len(readings) == 2 else "channels", columns=readings),
        DirectionSettings(columns=tuple(names[-2:]), form="alpha-inner"),
    )


def config_lines(readings: ReadingsSettings, direction: DirectionSettings) -> str:
    """Return the lines of a config that say what columns are."""
    units = f', unit = "{direction.unit}"' if isinstance(direction.unit, str) else ""
    return (
        "say in a config (--init writes one) "
        f'readings = {{kind = "{readings.kind}", columns = {_listed(readings.columns)}}} and '
        f'direction = {{form = "{direction.form}", columns = {_listed(direction.columns)}{units}}}'
    )


def _listed(names: Sequence[str]) -> str:
    return "[" + ", ".join(json.dumps(name, ensure_ascii=False) for name in names) + "]"
