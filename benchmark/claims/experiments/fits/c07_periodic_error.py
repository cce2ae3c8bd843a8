"""C07: a Fourier series beside a polynomial where the error is periodic (Pentke2022).

To the balances of a quadrant photodiode and a position-sensitive device a wave is added, along each
axis with a phase of its own: 0.005 high, which is some tenths of a degree, and of a period drawn
for each unit between 0.6 and 1.2, two to three waves over the field. Both models see the same
balances. `fourier-balance` takes as many harmonics as its calibration samples prefer, at most
seven; the polynomial is `polynomial-1d` of as many coefficients, which is how both are compared and
timed. Lines show every number of coefficients. Errors and run times are geometric means of both
sensors, run times those of 20,000 rows.
"""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.non_physical.fourier_balance import FourierBalance
from algorithms.models.non_physical.polynomial import AxisPolynomial
from benchmark.claims.benches import Seen, ratio, rms, times_s
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.fits.means import geometric
from benchmark.claims.experiments.fits.poses import Poses, errors, many
from benchmark.contract import Preset
from benchmark.datasets.standard import psd_single_aperture, qpd_single_aperture
from benchmark.seeds import generator

HEIGHT = 0.005
PERIODS = (0.6, 1.2)
#: Seven make 16 coefficients an axis, as many as a polynomial of the highest order, 15.
HARMONICS = range(1, 8)
COEFFICIENTS = tuple(2 + 2 * n for n in HARMONICS)


def trial(number: int) -> Trial:
    """Measure one unit of both sensors."""
    sensors = [
        _sensor(module.PRESET, number) for module in (qpd_single_aperture, psd_single_aperture)
    ]
    captures, costs, series, polynomials = zip(*sensors, strict=True)
    return Trial(
        {"captures": geometric(captures), "costs": geometric(costs)},
        {
            "Fourier series": (COEFFICIENTS, list(map(geometric, zip(*series, strict=True)))),
            "polynomial": (COEFFICIENTS, list(map(geometric, zip(*polynomials, strict=True)))),
        },
    )


def _sensor(preset: Preset, number: int) -> tuple[float, float, list[float], list[float]]:
    """Error and run time beside the other's, and both models' errors by their size."""
    rng = generator("claims", "C07", preset.name, number)
    period, phases = rng.uniform(*PERIODS), rng.uniform(0.0, 2.0 * np.pi, 2)
    seen = Seen(preset, unit=number)
    known, asked = (
        poses.moved(_wave(poses.features, period, phases))
        for poses in (Poses.of(seen, VoltageBalance, s) for s in ("calibration", "test"))
    )
    series = [rms(errors(FourierBalance(harmonics=n), known, asked)) for n in HARMONICS]
    curves = [rms(errors(AxisPolynomial(degree=2 * n + 1), known, asked)) for n in HARMONICS]
    free = FourierBalance()
    free.fit(known.features, known.sun)
    chosen = min(int(free.coefficients_.shape[1]) // 2 - 1, HARMONICS[-1])
    fourier, polynomial = FourierBalance(harmonics=chosen), AxisPolynomial(degree=2 * chosen + 1)
    for model in (fourier, polynomial):
        model.fit(known.features, known.sun)
    rows = many(asked.features)
    taken = times_s(
        fourier=lambda: fourier.predict(rows), polynomial=lambda: polynomial.predict(rows)
    )
    at = HARMONICS.index(chosen)
    return ratio(curves[at], series[at]), ratio(*taken.values()), series, curves


def _wave(balances: Floats, period: float, phases: Floats) -> Floats:
    return np.asarray(HEIGHT * np.sin(2.0 * np.pi * balances / period + phases))
