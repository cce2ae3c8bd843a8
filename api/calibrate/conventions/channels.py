"""Conventions of photodiodes found in a file: falling readings, order of quadrants and of faces."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations

import numpy as np

from algorithms.contract import FeatureKind
from api.calibrate.conventions.finding import MUCH_BETTER, Finding
from api.calibrate.face_normals import face_normals
from api.calibrate.readings import FALLING, Readings, quadrant_balances
from api.calibrate.robust import robust_map
from api.calibrate.settings import Settings

#: Correlation of all readings' sum with the cosine of incidence that says they are inverted.
_FALLING = 0.5
#: By how much a face's readings go better with the light on the one side than on the other.
_SURER = 0.1
#: Poses without light on a face that tell its level then.
_FEWEST_UNLIT = 6


def of_light(readings: Readings, settings: Settings) -> Iterator[Finding]:
    """Yield readings of quadrants, electrodes or faces that fall when light rises."""
    if readings.kind is FeatureKind.SIGNALS:
        yield from _falling_faces(readings, settings)
        return
    if settings.readings.kind not in ("quadrants", "electrodes"):
        return
    total = readings.raw.sum(axis=1)
    if np.corrcoef(total, readings.sun[:, 2])[0, 1] < -_FALLING:
        yield Finding(
            "light", f"{FALLING}: say inverted = true, and dark = their level without light",
            np.nan, np.nan, {}, True,
        )  # fmt: skip


def _falling_faces(readings: Readings, settings: Settings) -> Iterator[Finding]:
    """Yield faces whose readings, flat over the dark part of the field, fall over the lit one."""
    sun, signals, stated = readings.sun, readings.features, settings.readings
    dark = np.broadcast_to(np.asarray(stated.dark, dtype=np.float64), signals.shape[1])
    gain = np.broadcast_to(np.asarray(stated.gain, dtype=np.float64), signals.shape[1])
    levels, falling = [], []
    for signal in signals.T:
        mean = ((signal - np.median(signal))[:, None] * sun).mean(axis=0)
        towards = sun @ (mean / (np.linalg.norm(mean) or 1.0))
        with np.errstate(invalid="ignore"):
            rises, falls = (
                abs(np.corrcoef(signal, np.maximum(side, 0.0))[0, 1])
                for side in (towards, -towards)
            )
        falling.append(falls > max(rises + _SURER, _FALLING))
        unlit = towards > 0.1
        levels.append(float(np.median(signal[unlit])) if unlit.sum() >= _FEWEST_UNLIT else np.nan)
    if not all(falling):
        return
    sign = -1.0 if stated.inverted else 1.0
    change: dict[str, object] = {"inverted": not stated.inverted}
    if np.isfinite(levels).all():
        change["dark"] = tuple(float(value) for value in dark + sign * gain * np.asarray(levels))
    yield Finding(
        "light", f"{FALLING}: say inverted = true, and dark = their level without light",
        np.nan, np.nan, {"readings": change} if "dark" in change else {}, True,
    )  # fmt: skip


def of_quadrants(readings: Readings, settings: Settings) -> Iterator[Finding]:
    """Yield another order of the quadrants that explains the directions far better."""
    if settings.readings.kind != "quadrants":
        return
    signals = readings.raw
    left = {}
    for order in permutations(range(4)):
        if order[0] == 0:  # turned orders differ by axes alone
            features = quadrant_balances(signals[:, order])
            usable = np.isfinite(features).all(axis=1)
            if usable.all():
                _, size = robust_map(features, readings.sun)
                left[order] = float(np.median(size))
    stated = (0, 1, 2, 3)
    best = min(left, key=lambda order: left[order])
    # (0, 1, 2, 3) and (0, 3, 2, 1) go round the same way but for a mirror
    if best not in (stated, (0, 3, 2, 1)) and left[best] < MUCH_BETTER * left[stated]:
        columns = tuple(settings.readings.columns[at] for at in best)
        yield Finding(
            "quadrants", f"the quadrants seem to stand in the order {', '.join(columns)}",
            left[stated], left[best], {"readings": {"columns": columns}},
            left[best] < 0.3 * left[stated],
            "which quadrant comes first only the axes tell, once the order is right",
        )  # fmt: skip


def of_faces(readings: Readings, settings: Settings) -> Iterator[Finding]:
    """Yield channels that look where another one is stated to."""
    normals, explained = face_normals(readings)
    stated = settings.sensor.face_normals
    if stated is None or np.median(explained) < 0.5:
        return
    cosine = normals @ np.asarray(stated).T
    for at, name in enumerate(settings.readings.columns):
        nearest = int(np.argmax(cosine[at]))
        if nearest != at and cosine[at, nearest] > 0.8 and cosine[at, at] < 0.5:
            yield Finding(
                "faces",
                f"channel {name} looks where {settings.readings.columns[nearest]} is stated to",
                float(np.degrees(np.arccos(np.clip(cosine[at, at], -1, 1)))),
                float(np.degrees(np.arccos(np.clip(cosine[at, nearest], -1, 1)))), {}, True,
            )  # fmt: skip
