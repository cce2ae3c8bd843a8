"""Whether answers stand at another level of light, as far as the level without light is known."""

from __future__ import annotations

import numpy as np

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind, Model
from calibrate.causes.light import LESS_LIGHT, level_of_channels
from calibrate.conventions.channels import dark_of
from calibrate.readings import Readings, features_of
from calibrate.settings import Settings

_MOST = 500


def moved_by_less_light(model: Model, readings: Readings, settings: Settings) -> float:
    """Return by how much answers may move with a tenth less light, RMS, degrees.

    The level without light of each column in turn is taken to be wrong by its error; the largest
    change counts. NaN where readings are no light, or that level is not known.
    """
    kind = settings.readings.kind
    if kind not in ("quadrants", "electrodes", "channels"):
        return float("nan")
    used = readings.thinned(_MOST)
    signals = used.kind is FeatureKind.SIGNALS
    dark = level_of_channels(used, falls=False) if signals else dark_of(used, settings)
    if not np.isfinite(dark.error):
        return float("nan")
    as_is = model.predict(used.features, used.context)
    stated = settings.readings
    sign = -1.0 if stated.inverted else 1.0
    square = np.zeros(len(used))
    for column in range(used.raw.shape[1]):
        light = (1.0 - LESS_LIGHT) * used.raw
        light[:, column] += LESS_LIGHT * dark.error
        raw = np.asarray(stated.dark) + sign * np.asarray(stated.gain) * light
        moved = separation_deg(model.predict(features_of(raw, settings), used.context), as_is)
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
