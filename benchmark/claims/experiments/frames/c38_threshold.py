"""C38: the thresholded centroid beside the basic one, and where it collapses (He2005).

The discs carry noise from 0.5 to 100 % of the peak, dark level taken off. The rules judge the
method as it ships, whose threshold follows the frame's noise; the lines show fixed fractions of the
maximum, too, as the survey prints them. The bound is Cramer and Rao's of the same frames.
"""

from __future__ import annotations

import numpy as np

from algorithms.extractors.frames.centroid import BasicCentroid, ThresholdedCentroid
from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import NOISES, errors_px, ship, single

SKETCH = Sketch(log_x=True)

FRACTIONS = (0.1, 0.3, 0.5)


def trial(number: int) -> Trial:
    """Measure one draw of discs and noise."""
    drawn = single("C38", number)
    methods = {"bcm": ship(BasicCentroid), "bctm": ship(ThresholdedCentroid)}
    methods |= {f"bctm at {f:g}": ThresholdedCentroid(threshold=f) for f in FRACTIONS}
    errors = errors_px(drawn, methods, NOISES)
    bound = [drawn.bound_px(share) for share in NOISES]
    over = np.array(errors["bctm"]) / np.array(bound)
    at = NOISES.index(0.02)
    values = {
        "improves": ratio(errors["bcm"][at], errors["bctm"][at]),
        "collapses": ratio(float(np.nanmax(over)), float(np.nanmin(over))),
    }
    lines = {name: (NOISES, along) for name, along in errors.items()} | {"bound": (NOISES, bound)}
    return Trial(values, lines)
