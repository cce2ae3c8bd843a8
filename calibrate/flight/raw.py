"""Steps from a file's raw readings to what the model reads: two features, or signals of faces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from calibrate.calibration import Calibration
from calibrate.flight.program import Step
from calibrate.readings import MATRICES, Readings
from calibrate.settings import ReadingsSettings, Settings

#: Beyond this a reading is no number; of limits, that there is none.
LARGEST = 1e30
#: Of a limit, how far a reading may be rounded in the file and not on board.
_ROUNDING = 1e-6


@dataclass(frozen=True)
class RawLimits:
    """What readings of a sensor may be.

    Attributes
    ----------
    low, high : ndarray, shape (K,)
        Of each column of the settings: readings at or beyond them are clipped.
    least_light, most_light : float
        Of the sum of readings less dark over gain.
    """

    low: Floats
    high: Floats
    least_light: float
    most_light: float


def limits_of(found: Calibration) -> RawLimits:
    """Return the limits that a calibration found, as finite numbers that C can hold."""
    count, known = len(found.settings.readings.columns), found.limits
    of_light = np.isfinite(known.most_light)
    low = np.maximum(np.array(known.low or (-np.inf,) * count), -LARGEST)
    high = np.minimum(np.array(known.high or (np.inf,) * count), LARGEST)
    return RawLimits(
        np.where(low > -LARGEST, low + _ROUNDING * np.abs(low), low),
        np.where(high < LARGEST, high - _ROUNDING * np.abs(high), high),
        float(known.least_light) if of_light else -LARGEST,
        float(known.most_light) if of_light else LARGEST,
    )


def raw_readings(readings: Readings, settings: ReadingsSettings) -> Floats:
    """Return the readings (N, K) as the file had them, in the order of the settings' columns."""
    sign = -1.0 if settings.inverted else 1.0
    return np.asarray(sign * readings.raw * np.asarray(settings.gain) + np.asarray(settings.dark))


def columns_of(found: Calibration) -> tuple[str, ...]:
    """Return the columns of readings in the file's order."""
    known = set(found.settings.readings.columns)
    inside = tuple(name for name in found.columns if name in known)
    return inside if len(inside) == len(known) else found.settings.readings.columns


def places_of(columns: Sequence[str], settings: ReadingsSettings) -> NDArray[np.int64]:
    """Return the place (K,) in the file's order of each column of the settings."""
    return np.array([list(columns).index(name) for name in settings.columns])


def raw_steps(columns: Sequence[str], settings: Settings, limits: RawLimits) -> list[Step]:
    """Return the steps from raw readings to features."""
    stated = settings.readings
    count = len(stated.columns)
    sign = -1.0 if stated.inverted else 1.0
    steps = [
        Step(
            "readings",
            {
                "readings": count,
                "place": places_of(columns, stated),
                "dark": np.broadcast_to(np.asarray(stated.dark, dtype=np.float64), count).copy(),
                "gain": sign
                * np.broadcast_to(np.asarray(stated.gain, dtype=np.float64), count).copy(),
                "low": np.asarray(limits.low, dtype=np.float64),
                "high": np.asarray(limits.high, dtype=np.float64),
                "largest": LARGEST,
                "least": float(limits.least_light),
                "most": float(limits.most_light),
            },
            9 * count + 2,
        )
    ]
    if stated.kind == "quadrants":
        steps.append(Step("quadrants", {}, 12))
    if stated.kind == "electrodes":
        steps.append(Step("electrodes", {}, 8))
    matrix = np.eye(2)
    for transform in settings.apply:
        matrix = np.asarray(MATRICES[transform]) @ matrix
    if stated.kind != "channels" and not np.array_equal(matrix, np.eye(2)):
        steps.append(Step("axes", {"matrix": matrix}, 6))
    return steps
