"""C48: the centroid of the smoothed frame beside that of the frame itself (Chang2008).

The discs carry noise from 0.5 to 100 % of the peak, dark level taken off. Both methods sum the
whole frame, as published and as they ship. The lines show the centroids in a window of 25 px, too,
where smoothing carries light over the window's edge.
"""

from __future__ import annotations

from algorithms.extractors.frames.centroid import BasicCentroid, FilteredCentroid
from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import NOISES, errors_px, ship, single

SKETCH = Sketch(log_x=True)

WINDOW_PX = 25


def trial(number: int) -> Trial:
    """Measure one draw of discs and noise."""
    drawn = single("C48", number)
    methods = {
        "bcm": ship(BasicCentroid),
        "ifm": ship(FilteredCentroid),
        "bcm in a window": BasicCentroid(window_px=WINDOW_PX),
        "ifm in a window": FilteredCentroid(window_px=WINDOW_PX),
    }
    errors = errors_px(drawn, methods, NOISES)
    low, high = (NOISES.index(share) for share in (0.1, 1.0))
    values = {
        "improves": ratio(errors["bcm"][low], errors["ifm"][low]),
        "hurts": ratio(errors["ifm"][high], errors["bcm"][high]),
    }
    return Trial(values, {name: (NOISES, along) for name, along in errors.items()})
