"""Solar cells in orbit: warmth of body and light, age, and what stands still at the reference."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.metrics.bounds import unit_variance
from benchmark.simulator.flight.drift import REFERENCE_K, PhotodiodeDrift
from benchmark.simulator.flight.drifting_cells import DriftingSolarCellSensor
from benchmark.simulator.flight.time_series import TimedScene
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.solar_cells import SolarCellSensor

SUN = from_angles(np.array([10.0, -30.0, 45.0]), np.array([25.0, 5.0, -20.0]))


def flown() -> DriftingSolarCellSensor:
    sensor = datasets.get("pva-orbit").condition("nominal").sensor
    assert isinstance(sensor, DriftingSolarCellSensor)
    return sensor


def at(temperature_k: float, age_years: float) -> TimedScene:
    full, none = np.ones(3), np.zeros(3)
    return TimedScene(
        SUN, full, none, None, temperature_k=temperature_k * full, age_years=age_years * full
    )


def test_new_cells_as_warm_as_those_on_the_ground_give_the_same_currents() -> None:
    """By the ground sensor's own law of temperature, the coefficients' spread left out."""
    sensor = replace(flown(), drift=PhotodiodeDrift(gain_per_k=6e-4))
    ground = SolarCellSensor(**{f.name: getattr(sensor, f.name) for f in fields(SolarCellSensor)})
    pattern = sensor.fixed_pattern("unit")
    np.testing.assert_array_equal(pattern["cells"], ground.fixed_pattern("unit")["cells"])
    for celsius in (25.0, -40.0, 60.0):
        still = replace(ground, cells=replace(ground.cells, temperature_c=celsius))
        np.testing.assert_allclose(
            sensor.expected(at(celsius + 273.15, 0.0), pattern),
            still.expected(Scene(SUN, np.ones(3), np.zeros(3)), pattern),
            rtol=1e-12,
        )


def test_every_cell_warms_and_ages_by_its_own_coefficients() -> None:
    sensor = replace(flown(), cells=replace(flown().cells, heating_k=0.0))
    pattern = sensor.fixed_pattern("unit")
    new = sensor.expected(at(REFERENCE_K, 0.0), pattern)
    lit = new > 0
    warm = sensor.expected(at(REFERENCE_K + 50.0, 0.0), pattern)
    old = sensor.expected(at(REFERENCE_K, 2.0), pattern)
    per_k, per_year = (np.tile(pattern[n], (3, 1)) for n in ("gain_per_k", "loss_per_year"))
    np.testing.assert_allclose(warm[lit] / new[lit], (1.0 + 50.0 * per_k)[lit], rtol=1e-12)
    np.testing.assert_allclose(old[lit] / new[lit], (1.0 - 2.0 * per_year)[lit], rtol=1e-12)
    assert np.ptp(pattern["gain_per_k"]) > 1e-4


@pytest.mark.slow
def test_what_is_not_known_of_the_unit_is_drawn_over_units() -> None:
    """Variance over 2000 units without references, against the stated one."""
    sensor = replace(flown(), normal_error_deg=0.0)
    scene = at(REFERENCE_K - 80.0, 1.0)
    drawn = np.array([sensor.expected(scene, sensor.fixed_pattern(u)) for u in range(2000)])
    mean = drawn.mean(axis=0)
    stated = unit_variance(sensor, mean, scene, References(flats=0, darks=0))
    lit = mean > 0.05 * mean.max()
    np.testing.assert_allclose(drawn.var(axis=0)[lit], stated[lit], rtol=0.15)
