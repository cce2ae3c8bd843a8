"""Datasets of frames behind masks: spots where they are said to be, and their bounds."""

from __future__ import annotations

import importlib
import math
from dataclasses import replace

import numpy as np
import pytest

from benchmark.datasets import Preset
from benchmark.metrics.bounds import cramer_rao
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.layouts import grid
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON, Spectrum
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.lit_pixels import LitPixels
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)


def preset(name: str) -> Preset:
    module = importlib.import_module("benchmark.datasets.standard." + name.replace("-", "_"))
    return module.PRESET


WHOLE = ["cmos-multi-aperture", "cmos-encoded", "cmos-compound-eye"]
WINDOWS = ["cmos-slit", "ccd-single-aperture"]


def whole_spots(name: str, condition: str, sun: np.ndarray) -> np.ndarray:
    """How many shadows of holes lie whole on the detector, by direction."""
    data = preset(name)
    sensor, pattern = data.setups[condition].sensor, data.fixed_pattern(condition)
    sensor = replace(sensor, spectrum=None)
    boxes = sensor.boxes(Scene(sun, np.ones(len(sun)), np.zeros(len(sun))), pattern)
    size = sensor.detector.columns
    inside = (boxes[..., 0] > 0) & (boxes[..., 1] < size) & (boxes[..., 2] > 0)
    inside &= (boxes[..., 3] < size) & (boxes[..., 1] > boxes[..., 0])
    return (inside & (boxes[..., 3] > boxes[..., 2])).sum(axis=1)


def test_all_spots_are_seen_within_s_fov_and_a_varying_number_beyond() -> None:
    data = preset("cmos-multi-aperture")
    s_fov, x_fov = (data.regime[f"{k}_spots_half_fov_deg"] for k in ("all", "some"))
    assert len(data.setups["nominal"].sensor.camera.mask.apertures) == 100
    edge = np.linspace(-s_fov, s_fov, 7)
    sun = from_angles(np.repeat(edge, 7), np.tile(edge, 7))
    assert (whole_spots("cmos-multi-aperture", "nominal", sun) == 100).all()
    beyond = from_angles(np.array([x_fov, x_fov, s_fov + 4]), np.array([x_fov, 0.0, 0.0]))
    assert list(whole_spots("cmos-multi-aperture", "nominal", beyond)) == [81, 90, 90]
    assert data.directions.half_fov_deg == data.geometry.half_fov_deg == x_fov


def test_a_fifth_of_the_spots_is_missing() -> None:
    up = np.array([[0.0, 0.0, 1.0]])
    assert whole_spots("cmos-multi-aperture", "missing-apertures", up) == 80
    for name in WHOLE:
        passed = preset(name).fixed_pattern("missing-apertures")["transmission"]
        assert (passed == 0).mean() == pytest.approx(0.2, abs=1 / len(passed))
        assert np.array_equal(
            preset(name).fixed_pattern("missing-apertures")["apertures"],
            preset(name).fixed_pattern("nominal")["apertures"],
        )


@pytest.mark.parametrize("name", ["cmos-encoded", "cmos-compound-eye"])
def test_wherever_the_sun_is_enough_is_seen(name: str) -> None:
    for split in ("calibration", "test"):
        sun = preset(name).scene("nominal", split).sun
        assert whole_spots(name, "nominal", sun).min() >= 3


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "cmos-encoded",
        "ccd-single-aperture",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("cmos-multi-aperture", "cmos-compound-eye", "cmos-slit")
        ),
    ],
)
def test_frames_are_neither_dark_nor_saturated(name: str) -> None:
    data = preset(name)
    for condition, setup in data.setups.items():
        scene = data.scene(condition, "test").part(0, 3)
        pattern = data.fixed_pattern(condition)
        frames = setup.sensor.observe(scene, pattern, NoiseStreams.named("test"))
        assert frames.dtype == np.uint16
        pixels = setup.sensor.detector
        # no pixel of a dark frame of 65,536 is 5 read noises bright
        dark = pixels.offset_dn + 5.0 * pixels.read_noise_e / pixels.gain_e_per_dn
        assert frames.max() < 2**setup.sensor.detector.bits - 1, condition
        assert (frames.max(axis=(1, 2)) > dark).all(), condition
        assert np.mean(frames == 0) < 1e-3, condition


@pytest.mark.slow
@pytest.mark.parametrize("name", WINDOWS)
def test_spots_lie_inside_their_windows_but_for_their_skirts(name: str) -> None:
    """Light that is bent has no end: at a window's border it is below 2 % of the peak."""
    data = preset(name)
    for condition in data.conditions:
        sensor = data.setups[condition].sensor
        for split in ("calibration", "test"):
            scene = data.scene(condition, split)
            keep = np.abs(scene.sun[:, :2] / scene.sun[:, 2:]).max(axis=1)
            worst = np.argsort(keep)[-60:]
            part = Scene(
                scene.sun[worst],
                np.ones(60),
                np.zeros(60),
                scene.origin_px[worst],
            )
            frames = sensor.lit(part)
            border = max(frames[:, [0, -1]].max(), frames[:, :, [0, -1]].max())
            assert border < 0.02 * frames.max(), condition


@pytest.mark.slow
def test_the_slit_measures_one_angle_better_than_the_other() -> None:
    """Information is proportional to edge length: 0.72 mm of sides against 0.1 mm of ends."""
    data = preset("cmos-slit")
    setup, pattern = data.setups["nominal"], data.fixed_pattern("nominal")
    # near normal incidence, where both edges are as soft as each other
    sun = from_angles(np.array([0.3, -1.0, 2.0]), np.array([0.2, 1.5, -0.7]))
    scene = Scene(
        sun, np.ones(3), np.full(3, LIGHT.stray), setup.sensor.origins(sun, generator("test"))
    )
    bound = cramer_rao(setup.sensor, scene, pattern, LIGHT)
    ratio = bound.alpha_deg / bound.beta_deg
    assert ratio == pytest.approx(math.sqrt(0.72 / 0.1), rel=0.05)


def small(count: int, spacing: float = 0.25, sunlit: float = 20_000.0) -> MultiSpotSensor:
    detector = replace(
        preset("cmos-multi-aperture").setups["nominal"].sensor.detector,
        columns=160,
        rows=150,
        sunlit_e=sunlit,
    )
    mask = grid(count, count, spacing, Aperture("round", 0.1, 0.1))
    return MultiSpotSensor(Camera(0.4, mask), detector, spectrum=None)


def still(sun: np.ndarray) -> Scene:
    return Scene(sun, np.ones(len(sun)), np.full(len(sun), 0.002), np.zeros((len(sun), 2), int))


@pytest.mark.parametrize(
    "spectrum",
    [
        pytest.param(None, id="shadows"),
        pytest.param(SUNLIT_SILICON, id="diffracted", marks=pytest.mark.slow),
    ],
)
def test_the_bound_of_lit_pixels_is_the_bound_of_the_frame(spectrum: Spectrum | None) -> None:
    sensor = replace(small(3), spectrum=spectrum)
    pattern = sensor.fixed_pattern("unit")
    scene = still(from_angles(np.array([0.0, 12.0, 52.0]), np.array([3.0, -20.0, 50.0])))
    whole = cramer_rao(sensor, scene, pattern, LIGHT)
    lit = cramer_rao(LitPixels(sensor, scene, pattern), scene, pattern, LIGHT)
    assert lit.angle_deg == pytest.approx(whole.angle_deg, rel=1e-4)
    assert lit.alpha_deg == pytest.approx(whole.alpha_deg, rel=1e-4)
    assert (lit.angle_deg >= whole.angle_deg * (1 - 1e-7)).all()
    assert np.array_equal(lit.observable, whole.observable)


def test_a_frame_without_a_spot_has_no_bound() -> None:
    sensor = small(1)
    pattern = sensor.fixed_pattern("unit")
    scene = still(from_angles(np.array([0.0, 80.0]), np.array([3.0, 0.0])))
    bound = cramer_rao(LitPixels(sensor, scene, pattern), scene, pattern, LIGHT)
    assert list(bound.observable) == [True, False]
    assert bound.angle_deg[1] == math.inf


def test_the_bound_falls_with_the_root_of_the_spot_count() -> None:
    """Four and sixteen times the spots: half and a quarter (Rufino2009b: N^-1/2)."""
    sun = from_angles(np.linspace(-3, 3, 9), np.linspace(4, -4, 9))
    mean = []
    for count in (1, 2, 4):
        sensor = small(count)
        pattern = sensor.fixed_pattern("unit")
        lit = LitPixels(sensor, still(sun), pattern)
        mean.append(cramer_rao(lit, still(sun), pattern, LIGHT).rms_deg)
    assert mean[0] / mean[1] == pytest.approx(2, rel=0.03)
    assert mean[1] / mean[2] == pytest.approx(2, rel=0.03)


def test_the_bound_falls_with_the_root_of_the_light_once_shot_noise_rules() -> None:
    sun = from_angles(np.linspace(-3, 3, 5), np.linspace(4, -4, 5))
    mean = []
    for sunlit in (2e6, 8e6):
        sensor = small(2, sunlit=sunlit)
        detector = replace(sensor.detector, full_well_e=1e9, bits=30)
        sensor = replace(sensor, detector=detector)
        pattern = sensor.fixed_pattern("unit")
        lit = LitPixels(sensor, still(sun), pattern)
        mean.append(cramer_rao(lit, still(sun), pattern, LIGHT).rms_deg)
    assert mean[0] / mean[1] == pytest.approx(2, rel=0.03)
