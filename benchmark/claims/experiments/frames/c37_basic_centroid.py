"""C37: the basic centroid beside the other methods of one spot, as noise grows (Chang2008).

All see the same discs with noise from 0.5 to 20 % of the peak, dark level taken off; at more, most
methods find nothing. "Generally lower" accuracy is the geometric mean of the basic centroid's error
over the geometric mean of the others', noise by noise. That a background which is left draws the
basic centroid to the frame's middle is no noise and not counted.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.contract import Extractor
from algorithms.extractors.frames.balance import DoubleBalance
from algorithms.extractors.frames.centroid import (
    BasicCentroid,
    FilteredCentroid,
    ThresholdedCentroid,
)
from algorithms.extractors.frames.peak import PixelMax
from algorithms.extractors.frames.template import TemplateMatch
from algorithms.extractors.frames.threshold_average import MultipleThresholdCentroid
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import NOISES, errors_px, ship, single

SKETCH = Sketch(log_x=True)

METHODS: dict[str, type[Extractor]] = {
    "bcm": BasicCentroid,
    "bctm": ThresholdedCentroid,
    "dbcm": DoubleBalance,
    "mt-acm": MultipleThresholdCentroid,
    "ifm": FilteredCentroid,
    "tm": TemplateMatch,
    "pm": PixelMax,
}
SHARES = NOISES[:6]


def trial(number: int) -> Trial:
    """Measure one draw of discs and noise."""
    drawn = single("C37", number)
    errors = errors_px(drawn, {name: ship(m) for name, m in METHODS.items()}, SHARES)
    others = [along for name, along in errors.items() if name != "bcm"]
    typical = np.exp(np.nanmean(np.log(others), axis=0))  # of each noise; NaN where one is lost
    lower = math.exp(float(np.mean(np.log(np.array(errors["bcm"]) / typical))))
    values = {"sub-pixel": errors["bcm"][0], "lower": lower}
    # ifm's line lies upon bcm's
    lines = {name: (SHARES, along) for name, along in errors.items() if name != "ifm"}
    return Trial(values, lines)
