"""C04: what polynomials beyond the 11th order add (Chang2006).

Each unit of the study's photodiodes under slits is calibrated with every order of `polynomial-1d`
and tested on the Suns of the data set. The second method fits Chebyshev polynomials of the same
orders with NumPy alone and is scored in the same way.
"""

from __future__ import annotations

import numpy as np

from algorithms.angles import angles_from_sun, sun_from_angles
from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.non_physical.polynomial import AxisPolynomial
from benchmark.claims.benches import ConditionView, ratio, rms, separation
from benchmark.claims.experiment import Trial
from benchmark.datasets.standard import pd_slit

ORDERS = range(1, 16)


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = ConditionView(pd_slit.PRESET, unit=number)
    ours = [_error(seen, order) for order in ORDERS]
    chebyshev = [_chebyshev(seen, order) for order in ORDERS]
    lines = {"polynomial-1d": (tuple(ORDERS), ours), "numpy.polynomial": (tuple(ORDERS), chebyshev)}
    return Trial(_statistics(ours), lines, _statistics(chebyshev))


def _statistics(errors: list[float]) -> dict[str, float]:
    by_order = dict(zip(ORDERS, errors, strict=True))
    beyond = min(by_order[order] for order in range(12, 16))
    return {"little": ratio(beyond, by_order[11]), "before": ratio(by_order[3], by_order[11])}


def _error(seen: ConditionView, order: int) -> float:
    return rms(seen.errors(VoltageBalance, AxisPolynomial(degree=order)))


def _chebyshev(seen: ConditionView, order: int) -> float:
    known, asked = (seen.features(VoltageBalance, split) for split in ("calibration", "test"))
    angles = angles_from_sun(seen.samples("calibration").sun)
    said: Floats = np.column_stack(
        [
            np.polynomial.Chebyshev.fit(known[:, axis], angles[:, 1 - axis], order)(asked[:, axis])
            for axis in (0, 1)
        ]
    )[:, ::-1]
    return rms(separation(sun_from_angles(said), seen.samples("test").sun))
