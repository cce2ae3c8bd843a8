"""Temperature, gain and assembly drift; sensors that are inverted exactly through them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from bare_pixels import bare

from benchmark import datasets
from benchmark.simulator.flight.drift import (
    REFERENCE_K,
    ThermalCycle,
    dark_levels,
)
from benchmark.simulator.flight.orbit import CircularOrbit, sun_direction
from benchmark.simulator.flight.time_series import (
    DriftingFaceSensor,
    DriftingFrameSensor,
    TimedScene,
)
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.plates import CoverGlass
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor

ONE_COLOUR = Spectrum((650.0,), (1.0,))
ORBIT, SUN = CircularOrbit(node_deg=337.5, phase_deg=77.0), sun_direction(0.0)


def pd_sensor() -> DriftingFaceSensor:
    sensor = datasets.get("pd-orbit").condition("nominal").sensor
    assert isinstance(sensor, DriftingFaceSensor)
    return sensor


def ccd_sensor() -> DriftingFrameSensor:
    sensor = datasets.get("ccd-orbit").condition("nominal").sensor
    assert isinstance(sensor, DriftingFrameSensor)
    return sensor


def assembly_at(sensor: DriftingFrameSensor, moved: np.ndarray) -> Assembly:
    """The head of one sample, from its row of `moved`."""
    tilt_x, tilt_y, height, x, y = map(float, moved)
    turned = sensor.camera.assembly.rotation_deg
    return Assembly(tilt_x, tilt_y, turned, height, x, y)


def scene_at(sun: np.ndarray, temperature_k, age_years, origin=None) -> TimedScene:
    count = len(sun)
    return TimedScene(
        sun,
        np.ones(count),
        np.zeros(count),
        origin,
        temperature_k=np.broadcast_to(np.asarray(temperature_k, dtype=float), count),
        age_years=np.broadcast_to(np.asarray(age_years, dtype=float), count),
    )


def test_temperature_solves_its_differential_equation() -> None:
    """Stepped forward with an explicit rule for many orbits, it ends on the closed curve."""
    cycle = ThermalCycle()
    step = 2.0
    count = round(8 * ORBIT.period_s / step)
    time_s = step * np.arange(count)
    target = np.where(ORBIT.eclipsed(time_s, SUN), cycle.eclipse_k, cycle.sunlit_k)
    stepped = np.empty(count)
    value = 290.0
    for n in range(count):
        stepped[n] = value
        value += step / cycle.time_constant_s * (target[n] - value)
    closed = cycle.temperature(ORBIT, SUN, time_s)
    last = slice(-round(ORBIT.period_s / step), None)
    assert closed[last] == pytest.approx(stepped[last], abs=0.1)
    assert np.ptp(closed) > 20


def test_without_eclipse_the_temperature_stays() -> None:
    dawn = CircularOrbit(node_deg=90.0)
    found = ThermalCycle().temperature(dawn, SUN, np.linspace(0, 6000, 20))
    assert (found == 308.15).all()


@pytest.mark.slow
def test_the_flying_unit_is_the_one_on_the_ground_at_the_reference() -> None:
    """The drifting sensors reduce to the plain ones, element by element."""
    sun = from_angles(np.array([10.0, -30.0]), np.array([25.0, 5.0]))
    scene = scene_at(sun, REFERENCE_K, 0.0)
    flying = pd_sensor()
    ground = datasets.get("pd-maskless-cube").condition("nominal").sensor
    pattern = flying.fixed_pattern("test")
    assert np.array_equal(pattern["gain"], ground.fixed_pattern("test")["gain"])
    assert flying.expected(scene, pattern) == pytest.approx(
        ground.expected(scene, pattern), rel=1e-14
    )
    ccd = ccd_sensor()
    still = DiffractiveFrameSensor(ccd.camera, ccd.detector, ccd.window_px, ccd.window_jitter_px)
    origin = ccd.origins(sun, np.random.default_rng(2))
    seen = replace(scene, origin_px=origin)
    built = ccd.fixed_pattern("test")
    assert ccd.expected(seen, built) == pytest.approx(still.expected(seen, built), rel=1e-9)


def test_photodiodes_fade_and_warm_as_told() -> None:
    sensor = pd_sensor()
    sun = from_angles(np.full(3, 20.0), np.full(3, 35.0))
    pattern = sensor.fixed_pattern("test")
    new, warm, old = sensor.expected(
        scene_at(sun, [REFERENCE_K, REFERENCE_K + 20, REFERENCE_K], [0.0, 0.0, 0.5]), pattern
    )
    dark = sensor.readout.dark.at_25_c
    assert warm - dark * 2 ** (20 / 7) == pytest.approx(
        (new - dark) * (1 + 20 * pattern["gain_per_k"]), abs=1e-12
    )
    assert old - dark == pytest.approx(
        (new - dark) * (1 - 0.5 * pattern["loss_per_year"]), abs=1e-12
    )
    many = replace(sensor, normals=tuple((1.0, 0.0, 0.0) for _ in range(4000)))
    spread = many.fixed_pattern("test")
    assert spread["gain_per_k"].mean() == pytest.approx(1e-3, rel=0.02)
    assert spread["gain_per_k"].std() == pytest.approx(2e-4, rel=0.05)
    assert spread["loss_per_year"].std() == pytest.approx(0.01, rel=0.05)


def test_every_sample_is_projected_with_its_own_assembly() -> None:
    """Against one camera a sample, built with that sample's assembly; glass included."""
    sensor = ccd_sensor()
    rng = np.random.default_rng(3)
    sun = from_angles(rng.uniform(-45, 45, 6), rng.uniform(-45, 45, 6))
    scene = scene_at(sun, rng.uniform(250, 340, 6), rng.uniform(0, 3, 6))
    light = sensor.project(scene)
    for n, moved in enumerate(sensor.moved(scene)):
        assembly = assembly_at(sensor, moved)
        alone = replace(sensor.camera, assembly=assembly).project(sun[n : n + 1])
        assert light.rims_mm[:, n] == pytest.approx(alone.rims_mm[:, 0], abs=1e-12)
        assert light.light[n] == pytest.approx(alone.light[0], rel=1e-12)


def snell_spot_mm(sun: np.ndarray, assembly: Assembly, focal_mm: float) -> np.ndarray:
    """Where the chief ray lands behind 0.5 mm of glass (index 1.52), written out for the test."""
    head = assembly.matrix() @ sun
    sine = math.hypot(head[0], head[1])
    bent = math.asin(sine / 1.52)
    height = focal_mm + assembly.focal_length_error_mm
    run = (height - 0.5) * sine / head[2] + 0.5 * math.tan(bent)
    return run * head[:2] / sine + [assembly.offset_x_mm, assembly.offset_y_mm]


@pytest.mark.slow
def test_drift_moves_the_rendered_light_as_far_as_snell_says() -> None:
    """Through what a data set renders: its own scene, centroids of `lit`, with and without drift.

    A tenth of a pixel where drift is largest: tens of bounds.
    """
    preset = datasets.get("ccd-orbit")
    sensors = [preset.condition(name).sensor for name in ("nominal", "stable")]
    whole = preset.scene("nominal", "test")
    lit = np.flatnonzero(whole.irradiance > 0)[::29]
    scene = TimedScene(
        whole.sun[lit],
        whole.irradiance[lit],
        whole.stray[lit],
        np.asarray(whole.origin_px)[lit],
        temperature_k=whole.temperature_k[lit],
        age_years=whole.age_years[lit],
    )
    pixels = np.arange(64)
    spots, expected = [], []
    for sensor in sensors:
        assert isinstance(sensor, DriftingFrameSensor)
        light = sensor.lit(scene)
        total = light.sum(axis=(1, 2))
        x, y = light.sum(axis=1) @ pixels / total, light.sum(axis=2) @ pixels / total
        spots.append(np.column_stack([x, y]))
        expected.append(
            [
                snell_spot_mm(sun, assembly_at(sensor, moved), sensor.camera.focal_length_mm)
                for sun, moved in zip(scene.sun, sensor.moved(scene), strict=True)
            ]
        )
    seen = (spots[0] - spots[1]) * 0.013
    difference = np.asarray(expected[0]) - np.asarray(expected[1])
    assert np.abs(difference).max() > 0.1 * 0.013
    assert np.abs(seen - difference).max() < 1e-3 * 0.013
    # the frames themselves, noise and all, differ too
    frames = [preset.generate(name, "test", 40).observations for name in ("nominal", "stable")]
    assert (frames[0] != frames[1]).mean() > 0.01


def test_drifting_light_is_that_of_a_head_built_so() -> None:
    """In one colour, beside a still camera a sample, built with that sample's assembly."""
    sensor = replace(ccd_sensor(), window_px=(12, 10), spectrum=ONE_COLOUR)
    sun = from_angles(np.array([20.0, -35.0]), np.array([-10.0, 15.0]))
    origin = sensor.origins(sun, np.random.default_rng(6))
    scene = scene_at(sun, [250.0, 340.0], [0.2, 2.5], origin)
    light = sensor.lit(scene)
    assert light.sum() > 0
    for n, moved in enumerate(sensor.moved(scene)):
        camera = replace(sensor.camera, assembly=assembly_at(sensor, moved))
        still = DiffractiveFrameSensor(
            camera, sensor.detector, (12, 10), sensor.window_jitter_px, spectrum=sensor.spectrum
        )
        alone = Scene(sun[n : n + 1], np.ones(1), np.zeros(1), origin[n : n + 1])
        assert light[n] == pytest.approx(still.lit(alone)[0], rel=1e-6, abs=1e-9 * light[n].max())


def test_exact_geometry_inverts_the_drifting_assembly() -> None:
    """Known drift, thin mask, no glass: the spot gives the direction to below 1e-6 deg."""
    sensor = ccd_sensor()
    camera = replace(
        sensor.camera,
        glass=CoverGlass(),
        sun=SolarDisc(diameter_deg=0.0),
        mask=replace(sensor.camera.mask, thickness_mm=0.0),
    )
    sensor = replace(sensor, camera=camera)
    rng = np.random.default_rng(4)
    sun = from_angles(rng.uniform(-45, 45, 50), rng.uniform(-45, 45, 50))
    scene = scene_at(sun, rng.uniform(250, 340, 50), rng.uniform(0, 3, 50))
    spot = sensor.project(scene).rims_mm[0, :, 0]
    for n, moved in enumerate(sensor.moved(scene)):
        assembly = assembly_at(sensor, moved)
        height = camera.focal_length_mm + assembly.focal_length_error_mm
        head = np.array(
            [spot[n, 0] - assembly.offset_x_mm, spot[n, 1] - assembly.offset_y_mm, height]
        )
        found = assembly.matrix().T @ (head / np.linalg.norm(head))
        apart = math.degrees(np.linalg.norm(np.cross(found, sun[n])))
        assert apart < 1e-6


def test_known_gains_invert_the_drifting_cube() -> None:
    """Cosine faces and a point Sun: opposite faces' difference over gain is the direction."""
    sensor = replace(
        pd_sensor(), response="cosine", normal_error_deg=0.0, sun=SolarDisc(diameter_deg=0.0)
    )
    rng = np.random.default_rng(5)
    sun = rng.normal(size=(50, 3))
    sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    temperature, age = rng.uniform(250, 340, 50), rng.uniform(0, 3, 50)
    scene = scene_at(sun, temperature, age)
    pattern = sensor.fixed_pattern("test")
    currents = sensor.expected(scene, pattern)
    gain = pattern["gain"] * sensor.drift.factors(
        temperature, age, pattern["gain_per_k"], pattern["loss_per_year"]
    )
    light = (currents - dark_levels(sensor.readout.dark, temperature)[:, None]) / gain
    found = light[:, ::2] - light[:, 1::2]
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    apart = np.degrees(np.linalg.norm(np.cross(found, sun), axis=1))
    assert apart.max() < 1e-6


def test_dark_pixels_follow_the_temperature() -> None:
    sensor = replace(ccd_sensor(), window_px=(12, 10), spectrum=ONE_COLOUR)
    sensor = replace(sensor, detector=bare(sensor.detector))
    pattern = sensor.fixed_pattern("test")
    sun = np.tile([0.0, 0.0, 1.0], (2, 1))
    scene = replace(
        scene_at(sun, [REFERENCE_K, REFERENCE_K + 14.0], 0.0, np.full((2, 2), 200)),
        irradiance=np.zeros(2),
    )
    dark = sensor.expected(scene, pattern) - sensor.detector.offset_dn
    assert dark[1] == pytest.approx(4.0 * dark[0], rel=1e-9)
    mean = sensor.detector.dark.at_25_c * sensor.detector.exposure_s
    assert dark[0].mean() * sensor.detector.gain_e_per_dn == pytest.approx(mean, rel=0.02)
