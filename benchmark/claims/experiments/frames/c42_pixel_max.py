"""C42: the pixel of the largest profile entries beside three centroids (Coutinho2022).

Error on discs with 1 % noise as digital numbers above a pedestal; times of whole frames of 512 x
512 px with the same disc, as a detector hands them over.
"""

from __future__ import annotations

from algorithms.extractors.frames.balance import DoubleBalance
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.extractors.frames.peak import PixelMax
from algorithms.extractors.frames.threshold_average import MultipleThresholdCentroid
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
    drawn = single("C42", number)
    pm, bctm = ship(PixelMax), ship(ThresholdedCentroid)
    dbcm, mtacm = ship(DoubleBalance), ship(MultipleThresholdCentroid)
    methods = {"pm": pm, "bctm": bctm, "dbcm": dbcm, "mt-acm": mtacm}
    lines = {
        name: (SHARES, [drawn.error_px(method.extract(drawn.digital(s))) for s in SHARES])
        for name, method in methods.items()
    }
    large = single("C42", number, size_px=DETECTOR_PX, frames=20).digital(NOISE)
    times = times_s(
        pm=lambda: pm.extract(large),
        bctm=lambda: bctm.extract(large),
        dbcm=lambda: dbcm.extract(large),
        mtacm=lambda: mtacm.extract(large),
    )
    at = SHARES.index(NOISE)
    values = {
        "like": ratio(lines["pm"][1][at], lines["bctm"][1][at]),
        "faster": ratio(min(times[name] for name in ("bctm", "dbcm", "mtacm")), times["pm"]),
        "whole": lines["pm"][1][at],
    }
    return Trial(values, lines)
