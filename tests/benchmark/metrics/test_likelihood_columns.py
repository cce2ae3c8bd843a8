"""Maximum-likelihood estimates reach the bound where pixels and amplifiers err.

One CMOS window, whose columns share noise larger than a pixel's own; one CCD window; one line.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from most_likely_columns import errors_deg

from benchmark import datasets
from benchmark.metrics.bounds import cramer_rao
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.readout.pixel_errors import PixelErrors
from benchmark.simulator.scene import Scene

CASES = [
    ("cmos-single-aperture", None, 3.3, -2.2),
    (
        "cmos-single-aperture",
        PixelErrors(crosstalk=0.05, nonlinearity=0.05, column_offset_e=90.0, column_noise_e=60.0),
        3.3,
        -2.2,
    ),
    (
        "ccd-single-aperture",
        PixelErrors(crosstalk=0.05, smear=2e-3, nonlinearity=0.05),
        3.3,
        -2.2,
    ),
    (
        "pda-slit",
        PixelErrors(crosstalk=0.05, nonlinearity=0.05, column_offset_e=900.0, column_noise_e=300.0),
        21.3,
        -9.7,
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "errors", "alpha", "beta"), CASES)
def test_a_known_unit_with_errors_is_estimated_as_well_as_its_bound_says(
    name: str, errors: PixelErrors | None, alpha: float, beta: float
) -> None:
    """Of 400 trials: one standard error is at most 3.5 %. The first case is as it is sold."""
    setup = datasets.get(name).setups["nominal"]
    sensor: Any = setup.sensor
    detector = replace(sensor.detector, errors=errors or sensor.detector.errors)
    if hasattr(sensor, "window_px"):
        columns, rows = (size + 24 for size in sensor.window_px)
        detector = replace(detector, columns=columns, rows=rows)
        sensor = replace(sensor, window_jitter_px=0)
    setup = replace(setup, sensor=replace(sensor, detector=detector))
    sensor = setup.sensor
    sun = from_angles(np.array([alpha]), np.array([beta]))
    origin = sensor.origins(sun, generator("test"))
    one = Scene(sun, np.ones(1), np.full(1, setup.irradiance.stray), origin)
    bound = cramer_rao(sensor, one, sensor.fixed_pattern("test", name, 0), setup.irradiance)
    found = errors_deg(setup, one, (name,), 400)
    assert math.sqrt(2 * np.mean(found**2)) == pytest.approx(bound.angle_deg[0], rel=0.1)
