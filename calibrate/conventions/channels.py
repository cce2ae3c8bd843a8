"""Conventions of photodiodes found in a file: falling readings, order of quadrants and of faces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

import numpy as np

from algorithms.contract import FeatureKind, Floats
from calibrate.causes.light import (
    CERTAIN,
    Dark,
    changes_answers,
    falling,
    level_of_channels,
    level_of_products,
    level_of_sum,
    without_stray,
)
from calibrate.conventions.finding import MUCH_BETTER, Finding
from calibrate.readings import FALLING, Readings, quadrant_balances, raw_of
from calibrate.robust import least_absolute, robust_map
from calibrate.settings import Settings

#: What a cell whose readings fall with the light leaves, over what one whose readings rise leaves,
#: from which they fall.
_FALLING = 0.3
#: Share of the spread of four readings that planes of the direction leave of plain cells, and of
#: the product of their slopes, which quadrants under one opening would show.
_PLAIN, _OF_PRODUCT = 0.05, 0.2


def of_light(readings: Readings, settings: Settings, noise_deg: float) -> Iterator[Finding]:
    """Yield readings that fall when light rises, and a level without light that is not stated.

    Of quadrants, electrodes and channels. Levels that move answers, at other light, by less than
    the noise of single answers are not certain.
    """
    if readings.kind is FeatureKind.SIGNALS:
        falls = _falling_faces(readings)
        dark = level_of_channels(readings, falls)
    elif settings.readings.kind in ("quadrants", "electrodes"):
        falls, dark = falling(readings), dark_of(readings, settings)
    else:
        return
    unsure = replace(dark, level=np.full(len(dark.level), dark.error))
    settled = np.isfinite(dark.error) and not changes_answers(unsure, readings, noise_deg)
    if falls:
        change: dict[str, object] = {"inverted": not settings.readings.inverted}
        if settled:
            change["dark"] = _stated_as(dark, settings)
        yield Finding(
            "light", f"{FALLING}: say inverted = true, and dark = their level without light",
            np.nan, np.nan, {"readings": change} if settled else {}, True,
        )  # fmt: skip
    elif np.max(np.abs(dark.level)) > CERTAIN * dark.error:
        levels = _stated_as(dark, settings)
        found = (
            "the level without light seems to be "
            f"{', '.join(f'{level:.4g}' for level in levels)}, by {dark.by}"
        )
        # light takes no reading below that without it: a scale of the angles may have made this
        odd = not settings.readings.inverted and min(levels) < 0 <= readings.raw.min()
        if odd:
            found += ", below zero: state it if it is so, or look at the scale of the angles"
        yield Finding(
            "light", found, np.nan, np.nan, {} if odd else {"readings": {"dark": levels}},
            bool(settled and changes_answers(dark, readings, noise_deg)),
            "light that all channels see alike, as stray light, looks the same",
        )  # fmt: skip


def dark_of(readings: Readings, settings: Settings) -> Dark:
    """Return the level of quadrants or electrodes that is there without light, too."""
    if settings.readings.kind != "quadrants":
        return level_of_sum(readings)
    return _agreed(level_of_sum(readings), without_stray(level_of_products(readings), readings))


def level_of(readings: Readings, settings: Settings) -> Dark:
    """Return the level that all readings of quadrants or electrodes have, stray light in it."""
    found = level_of_sum(readings)
    if settings.readings.kind != "quadrants":
        return found
    return _agreed(found, level_of_products(readings))


def _agreed(one: Dark, other: Dark) -> Dark:
    """Return what of two levels is known best, as uncertain as the other contradicts it."""
    best, worse = sorted((one, other), key=lambda each: each.error)
    apart = float(np.abs(best.level - worse.level).max())
    if apart > CERTAIN * float(np.hypot(best.error, worse.error)):
        return replace(best, error=apart)
    return best


def _stated_as(dark: Dark, settings: Settings) -> tuple[float, ...]:
    """Return the level of each column as settings have it: in the file's own units."""
    level = raw_of(dark.level, settings.readings)
    return tuple(float(f"{value:.6g}") for value in level)


def _falling_faces(readings: Readings) -> bool:
    """Say whether the readings of all channels fall when light rises.

    A channel looks along the direction with which its readings change. They rise from a level with
    the light on that side of it, or fall to one with the light on the other; a cell that is lit
    everywhere does the first with light along, the second with light against it.
    """
    sun = readings.sun
    level = np.ones(len(sun))
    for signal in readings.features.T:
        # least squares: least absolute values would follow a half without light alone
        slope = np.linalg.lstsq(np.column_stack([level, sun]), signal, rcond=1e-12)[0][1:]
        along = sun @ (slope / (np.linalg.norm(slope) or 1.0))
        rising, falling_off = (
            least_absolute(np.column_stack([level, side]), signal)
            for side in (np.maximum(along, 0.0), np.minimum(along, 0.0))
        )
        if not falling_off < _FALLING * rising:
            return False
    return True


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


def of_cells(readings: Readings, settings: Settings) -> Iterator[Finding]:
    """Yield four readings that are no quadrants of one detector but plain cells, each tilted."""
    if settings.readings.kind == "quadrants" and plain_cells(readings):
        yield Finding(
            "channels",
            "the four readings go with the cosine of incidence on four tilted cells, not with a "
            "spot on quadrants",
            np.nan, np.nan, {"readings": {"kind": "channels"}}, True,
        )  # fmt: skip


def plain_cells(readings: Readings) -> bool:
    """Say whether four readings are planes of the direction, each of another slope.

    Quadrants under one opening are products ``(1 + a x) (1 + b y)`` times a cosine: beside planes
    they leave the product of both slopes.
    """
    tangents = readings.sun[:, :2] / readings.sun[:, [2]]
    for signal in readings.raw.T:
        design = np.column_stack([np.ones(len(signal)), readings.sun])
        fit = np.linalg.lstsq(design, signal, rcond=1e-12)[0]
        left = float(np.std(signal - design @ fit))
        if left > _PLAIN * float(np.std(signal)) or fit[3] == 0:
            return False
        product = fit[1] * fit[2] / fit[3] * tangents.prod(axis=1) * readings.sun[:, 2]
        if left > _OF_PRODUCT * float(np.std(product)):
            return False
    return True


def face_normals(readings: Readings) -> tuple[Floats, Floats]:
    """Return where each channel looks (K, 3), and how it goes with the light there (K,).

    By least squares of signal over the cosine: on all samples first, then on those that light it.
    """
    sun, signals = readings.sun, readings.features
    normals = np.zeros((signals.shape[1], 3))
    explained = np.zeros(signals.shape[1])
    for at, signal in enumerate(signals.T):
        normal, lit = np.zeros(3), np.ones(len(sun), dtype=np.bool_)
        for _ in range(20):
            if lit.sum() < 6:
                break
            found = np.linalg.lstsq(sun[lit], signal[lit], rcond=None)[0]
            length = np.linalg.norm(found)
            if not length > 0:
                break
            normal = found / length
            lit = sun @ normal > 0.2
        normals[at] = normal
        with np.errstate(invalid="ignore"):
            share = np.corrcoef(signal, np.maximum(sun @ normal, 0.0))[0, 1]
        explained[at] = share if np.isfinite(share) else 0.0
    return normals, explained
