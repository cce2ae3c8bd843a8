"""Conventions that names leave open, told by how well the readings follow from each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from algorithms.contract import FeatureKind, Floats
from calibrate.readings import Readings, readings_of
from calibrate.robust import robust_map
from calibrate.settings import Settings
from calibrate.table import Table, TableError

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
    from calibrate.conventions.findings import projective_left_deg  # noqa: PLC0415 - one use

    try:
        readings = readings_of(table, settings).thinned(_JUDGED)
    except TableError:
        return float("inf")
    if len(readings) < max(20, len(table) // 4 if len(table) <= _JUDGED else 20):
        return float("inf")
    if readings.kind is FeatureKind.SIGNALS:
        return float(np.median(robust_map(readings.features, readings.sun, 2)[1]))
    return projective_left_deg(readings)


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
