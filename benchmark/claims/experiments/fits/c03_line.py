"""C03: a straight line over a field of view that widens (Faizullin2017).

The calibration poses of `qpd-single-aperture` within a cone, behind the study's round aperture, are
fitted by `linear` and tested on the test Suns within the same cone; the widest holds the whole
field, corners too. Over all of it stands `polynomial-1d` beside, which is given as much. A denser
grid of poses than the data set's (2 degrees) and more test Suns fill the small cones; nothing else
is changed. The line answers a Sun of the cone wherever it is, so that no edge is left out.
"""

from __future__ import annotations

import math
from dataclasses import replace

from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.non_physical.linear import LinearFit
from algorithms.models.non_physical.polynomial import AxisPolynomial
from benchmark.claims.benches import ConditionView, rank_correlation, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.fits.poses import Poses, errors
from benchmark.datasets.fields import AngleField
from benchmark.datasets.standard import qpd_single_aperture

#: Of the sensor's square field, as its data set covers it; its corners are 50 degrees out.
SQUARE_DEG = 40.0
HALF_FIELDS_DEG = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0)


def trial(number: int) -> Trial:
    """Measure one unit."""
    dense = AngleField(SQUARE_DEG, steps=41, test_samples=2000)
    preset = replace(qpd_single_aperture.PRESET, directions=dense)
    seen = ConditionView(preset, "round-aperture", number)
    line = [_error(seen, half, LinearFit(extrapolation=math.inf)) for half in HALF_FIELDS_DEG]
    curve = [_error(seen, half, AxisPolynomial(extrapolation=math.inf)) for half in HALF_FIELDS_DEG]
    return Trial(
        {
            "grows": rank_correlation(HALF_FIELDS_DEG, line),
            "poor": ratio(line[-1], curve[-1]),
        },
        {"linear": (HALF_FIELDS_DEG, line), "polynomial-1d": (HALF_FIELDS_DEG, curve)},
    )


def _error(seen: ConditionView, half_deg: float, model: LinearFit | AxisPolynomial) -> float:
    known, asked = (
        Poses.of(seen, VoltageBalance, split).select(seen.incidence_deg(split) <= half_deg)
        for split in ("calibration", "test")
    )
    return rms(errors(model, known, asked))
