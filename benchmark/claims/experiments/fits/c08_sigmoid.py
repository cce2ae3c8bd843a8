"""C08: a sigmoid with one wave and an offset beside a polynomial of as many numbers (Pentke2022).

Units of a quadrant photodiode behind a square aperture and behind a round one are calibrated with
`sigmoid`, six numbers an axis, and with `polynomial-1d` of order 5, as many. Errors and run times
(of 20,000 rows) are geometric means over both apertures. The polynomial gives angles of balances,
the sigmoid balances of angles: it is inverted for every answer. The polynomial's error is drawn
beside the sigmoid's and decides nothing: the survey does not compare them.
"""

from __future__ import annotations

from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.non_physical.polynomial import AxisPolynomial
from algorithms.models.non_physical.sigmoid import SigmoidBalance
from benchmark.claims.benches import ConditionView, ratio, rms, times_s
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.fits.means import geometric
from benchmark.claims.experiments.fits.poses import many
from benchmark.datasets.standard import qpd_single_aperture

CONDITIONS = ("nominal", "round-aperture")
#: Six coefficients, as many as the sigmoid's numbers.
ORDER = 5
HALF_FIELD_DEG = 40.0


def trial(number: int) -> Trial:
    """Measure one unit behind both apertures."""
    sigmoids, curves, costs = zip(*(_aperture(c, number) for c in CONDITIONS), strict=True)
    return Trial(
        {
            "well": geometric(sigmoids) / HALF_FIELD_DEG,
            "costs": geometric(costs),
        },
        {"sigmoid": (CONDITIONS, sigmoids), "polynomial-1d, order 5": (CONDITIONS, curves)},
    )


def _aperture(condition: str, number: int) -> tuple[float, float, float]:
    """Both errors, and the sigmoid's run time over the polynomial's."""
    seen = ConditionView(qpd_single_aperture.PRESET, condition, unit=number)
    sigmoid = seen.calibrate(VoltageBalance, SigmoidBalance)
    curve = seen.calibrate(VoltageBalance, AxisPolynomial(degree=ORDER))
    rows = many(seen.features(VoltageBalance, "test"))
    taken = times_s(
        sigmoid=lambda: sigmoid.model.predict(rows), polynomial=lambda: curve.model.predict(rows)
    )
    return (
        rms(seen.errors_of(sigmoid, VoltageBalance)),
        rms(seen.errors_of(curve, VoltageBalance)),
        ratio(taken["sigmoid"], taken["polynomial"]),
    )
