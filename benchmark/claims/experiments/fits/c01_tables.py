"""C01: look-up tables beside polynomial and geometric models (He2013).

Units of a CMOS array and of a quadrant photodiode are calibrated with `lut` at its published
interval of 1 degree (its smoothing chosen by the calibration samples, as it ships), with
`polynomial-2d`, `lsq` and `pinhole`, all given the true directions. Errors are those on the test
Suns, run times those of answering 20,000 rows of features; of the two sensors the geometric mean is
taken. Tables of other intervals show what size costs and brings: entries are what a table stores.
"""

from __future__ import annotations

import math
from dataclasses import replace

from algorithms.contract import Extractor
from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.geometric.least_squares import LeastSquaresGeometry
from algorithms.models.geometric.pinhole import BuiltPinhole
from algorithms.models.lut.lookup_table import ErrorTable
from algorithms.models.non_physical.polynomial import SurfacePolynomial
from algorithms.pipeline import Pipeline
from benchmark.claims.benches import ConditionView, exponent, ratio, rms, times_s
from benchmark.claims.experiment import Line, Sketch, Trial
from benchmark.claims.experiments.fits.means import geometric
from benchmark.claims.experiments.fits.poses import many
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.standard import cmos_single_aperture, qpd_single_aperture

PUBLISHED_DEG = 1.0
INTERVALS_DEG = (0.5, PUBLISHED_DEG, 2.0, 4.0, 8.0, 16.0, 32.0)

SKETCH = Sketch(log_x=True)


def trial(number: int) -> Trial:
    """Measure one unit of both sensors."""
    lines: dict[str, Line] = {}
    values = [
        _sensor(
            ConditionView(with_true_directions(cmos_single_aperture.PRESET), unit=number),
            ThresholdedCentroid,
            lines,
        ),
        _sensor(
            ConditionView(with_true_directions(qpd_single_aperture.PRESET), unit=number),
            VoltageBalance,
            lines,
        ),
    ]
    faster, limited, size = zip(*values, strict=True)
    return Trial(
        {
            "faster": geometric(faster),
            "limited": geometric(limited),
            "size": sum(size) / len(size),
        },
        lines,
    )


def _sensor(
    seen: ConditionView, extractor: type[Extractor], lines: dict[str, Line]
) -> tuple[float, float, float]:
    """Speed and error of the published table beside the others, and how its size grows."""
    nominal = ErrorTable.for_sensor(seen.preset.geometry, extractor.about.kind)
    tables = [
        seen.calibrate(extractor, replace(nominal, interval_deg=step)) for step in INTERVALS_DEG
    ]
    found = [rms(seen.errors_of(table, extractor)) for table in tables]
    others = {
        "polynomial-2d": seen.calibrate(extractor, SurfacePolynomial),
        "lsq": seen.calibrate(extractor, LeastSquaresGeometry),
        "pinhole": seen.calibrate(extractor, BuiltPinhole),
    }
    least = min(rms(seen.errors_of(other, extractor)) for other in others.values())
    lines[f"lut, {seen.preset.detector}"] = (INTERVALS_DEG, found)
    lines[f"best of the others, {seen.preset.detector}"] = (
        INTERVALS_DEG,
        [least] * len(INTERVALS_DEG),
    )
    published = INTERVALS_DEG.index(PUBLISHED_DEG)
    entries = [_entries(table) for table in tables]
    return (
        _speed(seen, extractor, tables[published], [others["polynomial-2d"], others["lsq"]]),
        ratio(found[published], least),
        -exponent(INTERVALS_DEG, entries),
    )


def _entries(table: Pipeline) -> float:
    model = table.model
    return float(model.table_deg_.size) if isinstance(model, ErrorTable) else math.nan


def _speed(
    seen: ConditionView, extractor: type[Extractor], table: Pipeline, others: list[Pipeline]
) -> float:
    """Run time of the fastest of the others over the table's."""
    rows = many(seen.features(extractor, "test"))
    models = [table.model, *(other.model for other in others)]
    taken = times_s(**{m.about.name: lambda m=m: m.predict(rows) for m in models})
    return ratio(
        min(taken[other.model.about.name] for other in others), taken[table.model.about.name]
    )
