"""C09: what errors of the standard projection model come from (deBoer2013).

The tilts, the rotation and the offsets of each unit's assembly are scaled from none to twice what
careful work leaves; its focal length keeps its error. What the mean squared error loses when they
are set to zero is misalignment's share. The same unit at 80 deg C, with nothing compensated, says
whether temperature needs to be. Of the two sensors' shares the mean is taken, of their ratios the
geometric mean, as the rules average trials.

The quadrant photodiode has no condition ``hot`` of its own: it gets that of its family, dark
current that doubles every 7 K.
"""

from __future__ import annotations

import math
from functools import partial
from typing import Any

from algorithms.contract import Extractor
from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.geometric.standard_projection import StandardProjection
from benchmark.claims.benches import Seen, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.alterations import altered, assembled, misaligned
from benchmark.datasets.conditions.masked_photodiodes import at
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import cmos_single_aperture, qpd_single_aperture

TIMES = (0.0, 0.5, 1.0, 1.5, 2.0)
_HOT_C = 80.0


def trial(number: int) -> Trial:
    """Measure one unit of both sensors."""
    frames, quadrants = cmos_single_aperture.PRESET, qpd_single_aperture.PRESET
    pixels = _by_times(frames, ThresholdedCentroid, number)
    balance = _by_times(quadrants, VoltageBalance, number)
    hot = _error(Seen(frames, "hot", number), ThresholdedCentroid)
    warm = altered(quadrants, partial(_at, temperature_c=_HOT_C))
    hotter = _error(Seen(warm, unit=number), VoltageBalance)
    warming = (ratio(hot, pixels[1.0]), ratio(hotter, balance[1.0]))
    values = {
        "main": (_share(pixels) + _share(balance)) / 2.0,
        "temperature": math.sqrt(math.prod(warming)),
    }
    lines = {
        "cmos-single-aperture": (TIMES, list(pixels.values())),
        "qpd-single-aperture": (TIMES, list(balance.values())),
        "cmos-single-aperture at 80 deg C": ((1.0,), [hot]),
        "qpd-single-aperture at 80 deg C": ((1.0,), [hotter]),
    }
    return Trial(values, lines)


def _by_times(preset: Preset, extractor: type[Extractor], unit: int) -> dict[float, float]:
    presets = {times: assembled(preset, partial(misaligned, times=times)) for times in TIMES}
    return {t: _error(Seen(other, unit=unit), extractor) for t, other in presets.items()}


def _share(errors: dict[float, float]) -> float:
    return 1.0 - (errors[0.0] / errors[1.0]) ** 2


def _error(seen: Seen, extractor: type[Extractor]) -> float:
    return rms(seen.errors(extractor, StandardProjection))


def _at(sensor: Any, temperature_c: float) -> Any:
    return at(sensor, temperature_c)
