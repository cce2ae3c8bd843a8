"""C07: how much of a periodic error a Fourier series takes up, and at what cost (Pentke2022).

To the balances of a quadrant photodiode and a position-sensitive device a wave is added, along each
axis with a phase of its own: 0.005 high, which is some tenths of a degree, and one to four waves
over the field, drawn for each unit. `fourier-balance` and `polynomial-1d` each choose their size
from the calibration samples, which are given the true directions. The error that the wave adds, in
the mean square, is compared with what it adds to a Fourier series that was calibrated without it;
the share that is gone was captured. Lines show that share by the number of waves, the phases as
drawn. Of both sensors means are taken; run times are those of 20,000 rows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.non_physical.fourier_balance import FourierBalance
from algorithms.models.non_physical.polynomial import AxisPolynomial
from benchmark.claims.benches import ConditionView, ratio, rms, times_s
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.fits.means import geometric
from benchmark.claims.experiments.fits.poses import Poses, errors, many
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import psd_single_aperture, qpd_single_aperture
from benchmark.seeds import generator

SKETCH = Sketch(log_up=False)
HEIGHT = 0.005
#: Over the field: between what a polynomial of few terms follows and the series' highest order.
WAVES = (1.0, 4.0)
SHOWN = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)


@dataclass(frozen=True)
class WaveResult:
    """Of one sensor and wave: shares captured, the polynomial's error over the series', times."""

    series: float
    polynomial: float
    better: float
    slower: float


def trial(number: int) -> Trial:
    """Measure one unit of both sensors."""
    sensors = [_Sensor(m.PRESET, number) for m in (qpd_single_aperture, psd_single_aperture)]
    found = [sensor.measured(sensor.waves, timed=True) for sensor in sensors]
    shown = [[sensor.measured(waves) for waves in SHOWN] for sensor in sensors]
    pairs = list(zip(*shown, strict=True))
    return Trial(
        {
            "captures": float(np.mean([one.series for one in found])),
            "better": geometric([one.better for one in found]),
            "costs": geometric([one.slower for one in found]),
        },
        {
            "Fourier series": (SHOWN, [float(np.mean([o.series for o in p])) for p in pairs]),
            "polynomial": (SHOWN, [float(np.mean([o.polynomial for o in p])) for p in pairs]),
        },
    )


def capture(waved: float, plain: float, unknowing: float) -> float:
    """Share of a wave's mean squared error that a fit takes up.

    From the error with the wave fitted, the error with no wave at all, and that of a wave which
    the fit knew nothing of; 1 for all of it, 0 for none, below 0 where the fit is worse off.
    """
    return 1.0 - ratio(waved**2 - plain**2, unknowing**2 - plain**2)


class _Sensor:
    """One unit, given the true directions, and the wave drawn for it."""

    def __init__(self, preset: Preset, unit: int) -> None:
        rng = generator("claims", "C07", preset.name, unit)
        self.waves, self.phases = float(rng.uniform(*WAVES)), rng.uniform(0.0, 2.0 * np.pi, 2)
        seen = ConditionView(with_true_directions(preset), unit=unit)
        splits = (Poses.of(seen, VoltageBalance, split) for split in ("calibration", "test"))
        self.known, self.asked = splits
        self.field = float(np.nanmax(self.known.features) - np.nanmin(self.known.features))
        self.plain = rms(errors(FourierBalance(), self.known, self.asked))
        self.plain_polynomial = rms(errors(AxisPolynomial(), self.known, self.asked))

    def measured(self, waves: float, timed: bool = False) -> WaveResult:
        """Measure both models under so many waves over the field; run times where timed."""
        known, asked = (
            poses.shift(self._wave(poses.features, waves)) for poses in (self.known, self.asked)
        )
        unknowing = rms(errors(FourierBalance(extrapolation=0.1), self.known, asked))
        fourier, polynomial = FourierBalance(), AxisPolynomial()
        series, powers = (rms(errors(model, known, asked)) for model in (fourier, polynomial))
        slower = float("nan")
        if timed:
            rows = many(asked.features)
            taken = times_s(
                fourier=lambda: fourier.predict(rows), polynomial=lambda: polynomial.predict(rows)
            )
            slower = ratio(*taken.values())
        return WaveResult(
            capture(series, self.plain, unknowing),
            capture(powers, self.plain_polynomial, unknowing),
            ratio(powers, series),
            slower,
        )

    def _wave(self, balances: Floats, waves: float) -> Floats:
        return np.asarray(
            HEIGHT * np.sin(2.0 * np.pi * waves * balances / self.field + self.phases)
        )
