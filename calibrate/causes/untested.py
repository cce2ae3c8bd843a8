"""What a file does not tell of its sensor, and what would."""

from __future__ import annotations

import numpy as np

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind, Model
from calibrate.causes.kinks import largest_unnoticed
from calibrate.causes.lag import fraction_late
from calibrate.causes.laws import UNTESTED, scale_of_angles, settles_scale
from calibrate.causes.light import (
    LESS_LIGHT,
    Dark,
    changes_answers,
    largest_stray,
    level_of_channels,
)
from calibrate.conventions.channels import dark_of
from calibrate.readings import Readings, features_of, raw_of
from calibrate.robust import answer_noise_deg
from calibrate.settings import Settings

_MOST = 2000
_DARK = (
    "the level without light: {}; readings with the sensor covered, or at another light level, "
    "would test it"
)
_STRAY = (
    "whether the level found without light is stray light, which goes with the Sun's: answers move "
    "by half their noise or more at a tenth less light from {:.2g} of it on; readings with the "
    "sensor covered, or at another light level, would test it"
)
_HALF = (
    "another scale of one half of an axis: noise and the sensor's own distortion hide up to "
    "{:.2g} %; directions of a second turntable, or more poses, would test it"
)
_LAG = (
    "readings that come late by a part of a row: all sweeps go one way, or none is smooth; sweeps "
    "to and fro would test it"
)


def untested_in(
    readings: Readings, settings: Settings, *, dark_found: bool = False
) -> tuple[str, ...]:
    """Return which causes of a wrong calibration a file cannot show, each with what would.

    Settings are those applied; `dark_found` says whether their level without light was found in the
    file, not stated.
    """
    used = readings.thinned(_MOST)
    found = []
    noise = answer_noise_deg(used.features, used.sun)
    if not settles_scale(scale_of_angles(used, settings), used, noise):
        found.append(UNTESTED)
        if half := largest_unnoticed(readings, settings, noise):
            found.append(_HALF.format(100.0 * half))
    kind = settings.readings.kind
    if kind == "balance":
        found.append(_DARK.format("the file has balances, not the signals that they are made of"))
    elif kind in ("quadrants", "electrodes", "channels"):
        signals = used.kind is FeatureKind.SIGNALS
        dark = level_of_channels(used, falls=False) if signals else dark_of(used, settings)
        unsure = Dark(np.full(len(dark.level), dark.error), dark.error, dark.by)
        if not np.isfinite(dark.error) or changes_answers(unsure, used, noise):
            found.append(_DARK.format("the signals follow no law by which they tell it"))
        stray = largest_stray(used, noise) * float(np.abs(settings.readings.gain).max())
        if dark_found and not dark.told_apart and stray < np.abs(settings.readings.dark).max():
            found.append(_STRAY.format(stray))
    if not np.isfinite(fraction_late(readings)[1]):
        found.append(_LAG)
    return tuple(found)


_MOST_MOVED = 500


def moved_by_less_light(model: Model, readings: Readings, settings: Settings) -> float:
    """Return by how much answers may move with a tenth less light, RMS, degrees.

    The level without light of each column in turn is taken to be wrong by its error; the largest
    change counts. NaN where readings are no light, or that level is not known.
    """
    kind = settings.readings.kind
    if kind not in ("quadrants", "electrodes", "channels"):
        return float("nan")
    used = readings.thinned(_MOST_MOVED)
    signals = used.kind is FeatureKind.SIGNALS
    dark = level_of_channels(used, falls=False) if signals else dark_of(used, settings)
    if not np.isfinite(dark.error):
        return float("nan")
    as_is = model.predict(used.features, used.context)
    square = np.zeros(len(used))
    for column in range(used.raw.shape[1]):
        light = (1.0 - LESS_LIGHT) * used.raw
        light[:, column] += LESS_LIGHT * dark.error
        features = features_of(raw_of(light, settings.readings), settings)
        moved = separation_deg(model.predict(features, used.context), as_is)
        square = np.maximum(square, moved**2)
    known = np.isfinite(square)
    return float(np.sqrt(np.mean(square[known]))) if known.any() else float("nan")


def doubt_of_light(model: Model, readings: Readings, settings: Settings, stated_deg: float) -> str:
    """Return, in a sentence, that answers move by more than their error; empty where they stand."""
    moved = moved_by_less_light(model, readings, settings)
    if not moved > stated_deg:
        return ""
    return (
        f"answers may move by {moved:.3g} deg at a tenth less light: the model takes the light's "
        "level for known, or the level without light is not; take readings at other levels too, or "
        "with the sensor covered, and state those as dark"
    )
