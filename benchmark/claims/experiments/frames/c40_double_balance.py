"""C40: the double balance beside the thresholded centroid in error and in time (Xie2014).

Error on discs with 1 % noise as digital numbers above a pedestal. Times are of whole frames of
512 x 512 px with the same disc, as a detector hands them over: the survey's argument is that after
a quick look for the brightest pixel a window of 21 x 21 px is all that is worked on.
"""

from __future__ import annotations

from algorithms.extractors.frames.balance import DoubleBalance
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from benchmark.claims.benches import ratio, times_s
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import (
    DETECTOR_PX,
    NOISES,
    ship,
    single,
)

SKETCH = Sketch(log_x=True)

SHARES = NOISES[:6]
NOISE = 0.01


def trial(number: int) -> Trial:
    """Measure one draw of discs and noise."""
    drawn = single("C40", number)
    dbcm, bctm = ship(DoubleBalance), ship(ThresholdedCentroid)
    lines = {
        name: (SHARES, [drawn.error_px(method.extract(drawn.digital(s))) for s in SHARES])
        for name, method in (("dbcm", dbcm), ("bctm", bctm))
    }
    large = single("C40", number, size_px=DETECTOR_PX, frames=20).digital(NOISE)
    times = times_s(dbcm=lambda: dbcm.extract(large), bctm=lambda: bctm.extract(large))
    values = {
        "sub-pixel": lines["dbcm"][1][SHARES.index(NOISE)],
        "latency": ratio(times["bctm"], times["dbcm"]),
    }
    return Trial(values, lines)
