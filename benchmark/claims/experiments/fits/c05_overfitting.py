"""C05: whether polynomials of high order fit noise and not the sensor.

`polynomial-1d` of order 15 beside the same model at the order that cross-validation chooses from
the calibration poses alone, which may be 15 too. Once with all poses of each data set, as a
calibration has them; once with 64 drawn ones, four a coefficient of the highest order. Each trial
is another unit, given the true directions, with `DRAWS` draws of poses; of two sensors and all
draws geometric means are taken. Test Suns outside the poses' convex hull have no answer, of either
order.
"""

from __future__ import annotations

import numpy as np

from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.non_physical.polynomial import MAX_DEGREE, AxisPolynomial
from benchmark.claims.benches import ConditionView, draw, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.fits.means import geometric
from benchmark.claims.experiments.fits.poses import Poses, errors
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import psd_single_aperture, qpd_single_aperture
from benchmark.seeds import generator

FEW = 64
DRAWS = 5
ORDERS = range(1, MAX_DEGREE + 1)


def trial(number: int) -> Trial:
    """Measure one unit of both sensors."""
    every, few, lines = zip(
        *(_sensor(module.PRESET, number) for module in (qpd_single_aperture, psd_single_aperture)),
        strict=True,
    )
    names = ("all poses, test Suns", "all poses, the poses", "64 poses, test Suns")
    return Trial(
        {"practice": geometric(every), "few": geometric(few)},
        {
            name: (ORDERS, [geometric(pair) for pair in zip(*curves, strict=True)])
            for name, curves in zip(names, zip(*lines, strict=True), strict=True)
        },
    )


def worse(known: Poses, asked: Poses) -> float:
    """Test error of the highest order over that of the order chosen without the test Suns."""
    highest, chosen = (
        rms(errors(AxisPolynomial(degree=degree), known, asked)) for degree in (MAX_DEGREE, None)
    )
    return ratio(highest, chosen)


def _sensor(preset: Preset, unit: int) -> tuple[float, float, list[list[float]]]:
    """Ratio with all poses, the mean one with few, and errors by order."""
    seen = ConditionView(with_true_directions(preset), unit=unit)
    known, asked = (Poses.of(seen, VoltageBalance, split) for split in ("calibration", "test"))
    rng, rows = generator("claims", "C05", preset.name, unit), np.arange(len(known.sun))
    few = [known.select(draw(rows, FEW, rng)) for _ in range(DRAWS)]
    return (
        worse(known, asked),
        geometric([worse(poses, asked) for poses in few]),
        [
            [_error(order, known, asked) for order in ORDERS],
            [_error(order, known, known) for order in ORDERS],
            [_error(order, few[0], asked) for order in ORDERS],
        ],
    )


def _error(order: int, known: Poses, asked: Poses) -> float:
    return rms(errors(AxisPolynomial(degree=order), known, asked))
