"""C41: error and time of the multiple threshold centroid against the number of thresholds.

Gaussian spots of sigma 3 px with 1 % noise. The method is given an accuracy dx and takes as many
thresholds as sigma sqrt(e) / dx asks for, so dx is set for each number. "Enough" compares the
number that the shipped dx of 0.01 px asks for with four times it. Ranks are correlated from 4 to 64
thresholds; the line goes on to where noise is all that is left.
"""

from __future__ import annotations

import math

from algorithms.extractors.frames.threshold_average import MultipleThresholdCentroid
from benchmark.claims.benches import rank_correlation, ratio, times_s
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import single

SKETCH = Sketch(log_x=True)

SIGMA_PX, NOISE = 3.0, 0.01
NUMBERS = (4, 6, 8, 11, 16, 23, 32, 45, 64)
SHIPPED = MultipleThresholdCentroid()


def trial(number: int) -> Trial:
    """Measure one draw of spots and noise."""
    drawn = single("C41", number, profile="gaussian", scale_px=SIGMA_PX)
    frames = drawn.digital(NOISE)
    asked = round(SIGMA_PX * math.sqrt(math.e) / SHIPPED.accuracy_px)
    error = {
        n: drawn.error_px(_with(n).extract(frames)) for n in (*NUMBERS, 128, 256, asked, 4 * asked)
    }
    few, many = _with(4), _with(64)
    times = times_s(few=lambda: few.extract(frames), many=lambda: many.extract(frames))
    values = {
        "grows": rank_correlation(NUMBERS, [error[n] for n in NUMBERS]),
        "enough": ratio(error[asked], error[4 * asked]),
        "costs": ratio(times["many"], times["few"]),
    }
    bound = drawn.bound_px(NOISE)
    lines = {
        "mt-acm": (tuple(error), list(error.values())),
        "bound": (tuple(error), [bound] * len(error)),
    }
    return Trial(values, lines)


def _with(thresholds: int) -> MultipleThresholdCentroid:
    # the method takes the least whole number above sigma sqrt(e) / dx
    return MultipleThresholdCentroid(accuracy_px=SIGMA_PX * math.sqrt(math.e) / (thresholds - 0.5))
