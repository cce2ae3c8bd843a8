"""C33: what coded masks reach over a wide field (Wang2015, Wei2014, Wei2017).

Three sensors with the counts and fields of these studies (105 and 120 degrees square, a cone of 100
degrees) are calibrated as on a bench and tested over their whole field. Of each the better one of
`coded-correlation` and `coded-spacing` counts, of the three the geometric mean, and as field the
narrowest of theirs, as long as no more than one Sun in twenty is left without an answer. Lines of
the same sensors calibrated without a bench's errors show what is the mask's part in it.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.spot_list import SpotList
from algorithms.models.multiplex.coded_correlation import CodedCorrelation
from algorithms.models.multiplex.coded_spacing import CodedSpacing
from benchmark.claims.benches import ConditionView, middles, rms, rms_within
from benchmark.claims.experiment import Line, Trial
from benchmark.claims.experiments.fits.means import geometric
from benchmark.datasets.calibration import IDEAL
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import cmos_encoded, cmos_encoded_oblique, cmos_encoded_sizes

ARCSEC = 3600.0
EDGES_DEG = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)
#: Share of the Suns that has to be answered for a field to count as one.
ANSWERED = 0.95


def trial(number: int) -> Trial:
    """Measure one unit of each sensor."""
    lines: dict[str, Line] = {}
    modules = (cmos_encoded, cmos_encoded_sizes, cmos_encoded_oblique)
    errors, fields = zip(*(_sensor(m.PRESET, number, lines) for m in modules), strict=True)
    return Trial({"arcseconds": geometric(errors), "field": min(fields)}, lines)


def _sensor(preset: Preset, number: int, lines: dict[str, Line]) -> tuple[float, float]:
    """Error in arcseconds and full field in degrees."""
    bench, field = math.nan, math.nan
    # one after the other, so that the second looks up the light of the first
    for condition, name in (
        ("nominal", preset.name),
        (IDEAL, f"{preset.name}, calibrated ideally"),
    ):
        seen = ConditionView(preset.with_ideal_calibration(), condition, unit=number)
        least = min(
            (seen.errors(SpotList, model) for model in (CodedCorrelation, CodedSpacing)), key=rms
        )
        places = (
            middles(EDGES_DEG),
            [ARCSEC * error for error in rms_within(least, seen.incidence_deg(), EDGES_DEG)],
        )
        lines[name] = places
        if condition == "nominal":
            bench, field = ARCSEC * rms(least), _field(preset, least)
    return bench, field


def _field(preset: Preset, errors: Floats) -> float:
    half = preset.geometry.half_fov_deg
    answered = float(np.isfinite(errors).mean())
    return 2.0 * half if half is not None and answered >= ANSWERED else math.nan
