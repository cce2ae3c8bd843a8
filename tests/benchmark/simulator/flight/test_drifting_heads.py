"""Quadrants and lines whose heads drift, sample by sample against sensors that stand still."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.simulator.flight.drift import AssemblyDrift
from benchmark.simulator.flight.drifting_lines import DriftingLineSensor
from benchmark.simulator.flight.drifting_quadrants import DriftingQuadrantSensor
from benchmark.simulator.flight.time_series import TimedScene
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.line_sensor import LineSensor
from benchmark.simulator.sensors.quadrants import QuadrantSensor

FLIGHTS = {
    "qpd-orbit": (DriftingQuadrantSensor, QuadrantSensor),
    "ccd-multi-slit-orbit": (DriftingLineSensor, LineSensor),
}
REFERENCE_K = 298.15


def scene_at(temperature_k, age_years, count=6):
    rng = np.random.default_rng(3)
    sun = from_angles(rng.uniform(-25, 25, count), rng.uniform(-25, 25, count))
    full, none = np.ones(count), np.zeros(count)
    return TimedScene(
        sun, full, none, None,
        temperature_k=np.broadcast_to(temperature_k, count).astype(np.float64),
        age_years=np.broadcast_to(age_years, count).astype(np.float64),
    )  # fmt: skip


def parts_of(name):
    """The flown sensor, and one that stands still with the same parts."""
    flown, still = FLIGHTS[name]
    sensor = datasets.get(name).condition("nominal").sensor
    assert isinstance(sensor, flown)
    return sensor, still(**{f.name: getattr(sensor, f.name) for f in fields(still)})


def drift_of(sensor):
    return sensor.assembly if isinstance(sensor, DriftingQuadrantSensor) else sensor.drift


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_new_sensor_at_the_reference_temperature_is_the_one_that_stands_still(name):
    sensor, still = parts_of(name)
    scene, pattern = scene_at(REFERENCE_K, 0.0), sensor.fixed_pattern("here")
    np.testing.assert_allclose(sensor.lit(scene), still.lit(scene), rtol=1e-12, atol=1e-15)
    plain = {key: pattern[key] for key in still.fixed_pattern("here")}
    np.testing.assert_array_equal(plain["gain"], still.fixed_pattern("here")["gain"])
    np.testing.assert_allclose(
        sensor.expected(scene, pattern), still.expected(scene, plain), rtol=1e-12
    )


@pytest.mark.parametrize("name", FLIGHTS)
def test_every_sample_is_seen_by_a_head_of_its_own(name):
    sensor, still = parts_of(name)
    warm, old = np.linspace(250.0, 330.0, 6), np.linspace(0.0, 2.0, 6)
    scene, drift = scene_at(warm, old), drift_of(sensor)
    seen = sensor.lit(scene)
    built = sensor.camera.assembly
    for n in range(6):
        kelvin, years = float(warm[n] - REFERENCE_K), float(old[n])
        head = replace(
            built,
            tilt_x_deg=built.tilt_x_deg + drift.tilt_x_deg_k * kelvin
            + drift.tilt_x_deg_year * years,
            tilt_y_deg=built.tilt_y_deg + drift.tilt_y_deg_k * kelvin
            + drift.tilt_y_deg_year * years,
            focal_length_error_mm=built.focal_length_error_mm
            + drift.focal_length_mm_k * kelvin + drift.focal_length_mm_year * years,
            offset_x_mm=built.offset_x_mm + drift.offset_x_mm_k * kelvin
            + drift.offset_x_mm_year * years,
            offset_y_mm=built.offset_y_mm + drift.offset_y_mm_k * kelvin
            + drift.offset_y_mm_year * years,
        )  # fmt: skip
        alone = replace(still, camera=replace(still.camera, assembly=head))
        np.testing.assert_allclose(
            seen[n], alone.lit(scene.part(n, n + 1))[0], rtol=1e-9, atol=1e-12
        )
    at_rest = still.lit(scene)
    assert np.abs(seen - at_rest).max() > 1e-5 * at_rest.max()


def test_gains_and_dark_currents_follow_temperature_and_age():
    sensor, _ = parts_of("qpd-orbit")
    sensor = replace(sensor, assembly=AssemblyDrift())
    pattern = sensor.fixed_pattern("here")
    cold, warm = (sensor.expected(scene_at(t, 0.0), pattern) for t in (REFERENCE_K, 318.15))
    level = sensor.readout.dark.at_25_c
    factor = 2.0 ** (20.0 / sensor.readout.dark.doubling_k)
    light = (cold - level) * (1.0 + 20.0 * pattern["gain_per_k"])
    np.testing.assert_allclose(warm, light + level * factor, rtol=1e-12)
    aged = sensor.expected(scene_at(REFERENCE_K, 1.0), pattern)
    np.testing.assert_allclose(aged - level, (cold - level) * (1.0 - pattern["loss_per_year"]))
    assert np.ptp(pattern["gain_per_k"]) > 0 < np.ptp(pattern["loss_per_year"])


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_scene_without_time_and_a_ghost_are_refused(name):
    sensor, _ = parts_of(name)
    scene = scene_at(REFERENCE_K, 0.0)
    untimed = Scene(scene.sun, scene.irradiance, scene.stray, None)
    with pytest.raises(TypeError, match="TimedScene"):
        sensor.lit(untimed)
    with pytest.raises(ValueError, match="ghost"):
        replace(sensor, ghost=Ghost())
