"""Samples of a calibration without a file: features, directions and runs as arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import FeatureKind
from calibrate.conventions.finding import Finding
from calibrate.conventions.findings import findings
from calibrate.readings import Readings, readings_of
from calibrate.roles import guess
from calibrate.table import Table

Array = NDArray[np.float64]


def samples(
    features: Array,
    sun: Array,
    kind: FeatureKind = FeatureKind.SPOT,
    run: NDArray[np.int64] | None = None,
    angles: Array | None = None,
    **context: Array,
) -> Readings:
    """Readings of one file whose header is row 1; a single run unless told otherwise."""
    runs = np.zeros(len(sun), dtype=np.int64) if run is None else run
    return Readings(
        features,
        sun,
        kind,
        np.arange(len(sun)) + 2,
        runs,
        tuple(f"run{n}" for n in range(int(runs.max()) + 1)),
        features,
        context,
        angles,
    )


def table(names: tuple[str, ...], *columns: Array) -> Table:
    """A file of columns side by side, each (N,) or (N, K)."""
    return Table(dict(zip(names, np.column_stack(columns).T, strict=True)), 2, "bench.csv", {})


def found_in(made: Table) -> list[Finding]:
    """Conventions that seem to be others than the columns' names say."""
    stated = guess(made)
    return findings(readings_of(made, stated), stated)


def spot_table(features: Array, angles: Array, unit: str = "_deg") -> Table:
    """A file of spots and angles, whose columns name the unit."""
    return table(("x_px", "y_px", f"theta_x{unit}", f"theta_y{unit}"), features, angles)
