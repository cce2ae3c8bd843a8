"""Limits of readings: beyond them rows were left out, and flight code answers with a flag."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from calibrate.causes.bad_cells import Level
from calibrate.readings import FAINT, Readings
from calibrate.settings import Settings

#: Most light that is answered, in units of the most that was measured.
_MORE_LIGHT = 2.0


@dataclass(frozen=True)
class ReadingLimits:
    """Readings between these limits, the limits themselves excluded, may be used.

    Attributes
    ----------
    low, high : tuple of float
        By column of readings, in the file's own units: levels at which readings were found to be
        sentinels, saturated or clipped; minus and plus infinity where none was found.
    least_light, most_light : float
        Of the sum of the readings less dark over gain: a tenth of the usual light, below which rows
        are left out, and twice the most light that was measured. 0 and infinity where readings do
        not measure light.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    least_light: float
    most_light: float


def limits_of(readings: Readings, settings: Settings, levels: Mapping[str, Level]) -> ReadingLimits:
    """Return the limits of readings that were fitted.

    Parameters
    ----------
    readings : Readings
        That were fitted.
    settings : Settings
    levels : mapping of str to Level
        Placeholder values by column, such as -999, found by `calibrate.causes.bad_cells`.
    """
    known = [levels.get(name, Level()) for name in settings.readings.columns]
    least, most = 0.0, np.inf
    if settings.readings.kind in ("quadrants", "electrodes", "channels"):
        total = readings.raw.sum(axis=1)
        least = FAINT * float(np.percentile(total, 95))
        most = _MORE_LIGHT * float(total.max())
    return ReadingLimits(
        tuple(one.low for one in known), tuple(one.high for one in known), max(least, 0.0), most
    )
