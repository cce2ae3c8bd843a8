"""C49: the template method beside the thresholded and the filtered centroid (Chang2008).

The discs carry noise from 2 to 20 % of the peak, dark level taken off; the template is the disc's
own outline. The lines show the grey frame under the same outline, too, which is ours.
"""

from __future__ import annotations

import numpy as np

from algorithms.extractors.frames.centroid import FilteredCentroid, ThresholdedCentroid
from algorithms.extractors.frames.template import TemplateMatch
from benchmark.claims.benches import exponent, ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import (
    NOISES,
    RADIUS_PX,
    errors_px,
    ship,
    single,
)

SKETCH = Sketch(log_x=True)

SHARES = NOISES[2:6]


def trial(number: int) -> Trial:
    """Measure one draw of discs and noise."""
    drawn = single("C49", number)
    methods = {
        "tm": ship(TemplateMatch),
        "bctm": ship(ThresholdedCentroid),
        "ifm": ship(FilteredCentroid),
        "tm, grey frame": TemplateMatch(width_px=2.0 * RADIUS_PX, binarise=False),
    }
    errors = errors_px(drawn, methods, SHARES)
    mean = {name: float(np.exp(np.mean(np.log(along)))) for name, along in errors.items()}
    values = {
        "bctm": ratio(mean["bctm"], mean["tm"]),
        "ifm": ratio(mean["ifm"], mean["tm"]),
        "flat": exponent(SHARES, errors["tm"]),
    }
    lines = {name: (SHARES, along) for name, along in errors.items()}
    lines["bound"] = (SHARES, [drawn.bound_px(share) for share in SHARES])
    return Trial(values, lines)
