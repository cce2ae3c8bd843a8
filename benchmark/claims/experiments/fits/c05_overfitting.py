"""C05: polynomials of high order fitted to few poses.

Of the calibration poses of `qpd-single-aperture`'s standard unit 25 are drawn, other ones in every
trial, and `polynomial-1d` of each order is fitted to them. The error on these poses is set beside
that on the test Suns. Test Suns outside the poses' convex hull have no answer, as in the data set.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from algorithms.contract import UnusableDataError
from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.non_physical.polynomial import AxisPolynomial
from benchmark.claims.benches import Seen, drawn, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.fits.poses import Poses, errors
from benchmark.datasets.standard import qpd_single_aperture
from benchmark.seeds import generator

POSES = 25
ORDERS = range(1, 16)


def trial(number: int) -> Trial:
    """Measure one draw of poses."""
    known, asked = _standard_unit()
    few = known.chosen(drawn(np.arange(len(known.sun)), POSES, generator("claims", "C05", number)))
    trained = [_error(order, few, few) for order in ORDERS]
    tested = [_error(order, few, asked) for order in ORDERS]
    gaps = dict(zip(ORDERS, map(ratio, tested, trained), strict=True))
    return Trial(
        {"gap": ratio(gaps[15], gaps[3]), "worse": ratio(tested[-1], float(np.nanmin(tested)))},
        {"on the test Suns": (ORDERS, tested), "on the 25 poses": (ORDERS, trained)},
    )


@cache
def _standard_unit() -> tuple[Poses, Poses]:
    seen = Seen(qpd_single_aperture.PRESET)
    calibration, test = (Poses.of(seen, VoltageBalance, s) for s in ("calibration", "test"))
    return calibration, test


def _error(order: int, known: Poses, asked: Poses) -> float:
    """Root mean square in degrees; NaN where the poses do not settle the order."""
    try:
        return rms(errors(AxisPolynomial(degree=order), known, asked))
    except UnusableDataError:
        return math.nan
