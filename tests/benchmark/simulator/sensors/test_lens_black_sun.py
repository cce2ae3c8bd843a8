"""The black Sun: pixels invert where their reset level gives way, and only there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.metrics.bounds import cramer_rao
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import from_angles, tangent_axes
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.black_sun import BlackSunSensor

PRESET = datasets.get("cmos-lens")
SUNS = [(0.0, 0.0), (12.3, -31.7), (38.0, 38.0), (-25.2, 4.1)]


def sensor_of(condition: str = "nominal") -> BlackSunSensor:
    sensor = PRESET.setups[condition].sensor
    assert isinstance(sensor, BlackSunSensor)
    return sensor


def scene_of(angles: list[tuple[float, float]], repeats: int = 1) -> Scene:
    alpha, beta = np.repeat(np.array(angles), repeats, axis=0).T
    count = len(alpha)
    origin = np.zeros((count, 2), dtype=np.int64)
    return Scene(from_angles(alpha, beta), np.ones(count), np.full(count, 2e-4), origin)


def test_inversion_sets_in_exactly_at_the_threshold() -> None:
    sensor = sensor_of()
    full, threshold = sensor.camera.detector.full_well_e, sensor.reset_threshold_e
    reset = threshold + np.array([-5000.0, -1.0, 0.0, 1.0, 0.25 * full, full, full + 1, 1e9])
    put_out = sensor.difference(np.full(8, 1e9), reset)
    assert put_out.tolist() == [full, full, full, full - 1, 0.75 * full, 0.0, 0.0, 0.0]
    assert sensor.difference(np.array([37.0]), np.array([3.0])).tolist() == [37.0]


def test_in_the_picture_every_pixel_above_the_threshold_is_low_and_no_other() -> None:
    # a converter that does not clip, no dead pixels: every electron shows
    camera = sensor_of().camera
    detector = replace(camera.detector, gain_e_per_dn=1.0, offset_dn=0.0, bits=15)
    sensor = replace(sensor_of(), camera=replace(camera, detector=detector, dead_share=0.0))
    pattern = sensor.fixed_pattern("unit")
    scene = scene_of(SUNS)
    light = sensor.camera.photo_electrons(scene, pattern)
    picture = sensor.picture(scene, pattern)
    reset = light * sensor.reset_s / detector.exposure_s
    saturated = light + pattern["dark_e"] >= detector.full_well_e
    inverted = reset > sensor.reset_threshold_e
    assert np.array_equal(saturated & (picture < detector.full_well_e), inverted)
    assert (picture[reset >= sensor.reset_threshold_e + detector.full_well_e] == 0).all()
    assert inverted.sum(axis=(1, 2)).min() > 20


@pytest.mark.parametrize(
    ("condition", "rim"), [("nominal", 5.5), ("misaligned", 5.5), ("high-noise", 5.5), ("glare", 8)]
)
def test_the_sun_is_black_within_a_white_halo_wherever_it_stands(
    condition: str, rim: float
) -> None:
    sensor = sensor_of(condition)
    detector = sensor.camera.detector
    scene = scene_of(SUNS)
    pattern = PRESET.fixed_pattern(condition)
    pattern = {**pattern, "alive": np.ones_like(pattern["alive"])}
    frames = sensor.observe(scene, pattern, NoiseStreams.named("test", condition)).astype(float)
    rows, columns = np.indices(frames.shape[1:])
    for frame, (x, y) in zip(frames, sensor.camera.image_px(scene.sun), strict=True):
        radius = np.hypot(columns - x, rows - y)
        assert frame[radius < 1.5].max() < detector.offset_dn + 60
        ring = (radius > rim) & (radius < rim + 2.5)
        assert (frame[ring] == detector.full_scale_dn).mean() > 0.95
        assert np.median(frame) < 0.25 * detector.full_scale_dn
        black = (radius < rim) & (frame < detector.full_scale_dn / 2)
        assert 20 < black.sum() < 120
        centre = columns[black].mean(), rows[black].mean()
        assert centre == pytest.approx((x, y), abs=0.25)


@pytest.mark.slow
def test_noise_is_that_of_the_sample_that_varies() -> None:
    """Spread over 120 pictures against `variance`, outside the kinks between the regimes."""
    sensor = sensor_of()
    detector = sensor.camera.detector
    pattern = PRESET.fixed_pattern("nominal")
    repeats = 120
    scene = scene_of([(12.3, -31.7)], repeats)
    seen = sensor.observe(scene, pattern, NoiseStreams.named("test", "spread")).astype(float)
    one = scene.part(0, 1)
    unfolded = sensor.expected(one, pattern)[0]
    deviation = np.sqrt(sensor.variance(unfolded)) / detector.gain_e_per_dn
    ratio = seen.std(axis=0, ddof=1) / deviation
    picture = sensor.picture(one, pattern)[0]
    white = sensor.white_e
    room = 6 * deviation * detector.gain_e_per_dn
    inside = (picture > detector.offset_dn + 6 * deviation) & (pattern["alive"] > 0)
    dim = inside & (unfolded < white - room)
    dark_rim = inside & (unfolded > white + room)
    assert dim.sum() > 50_000
    assert dark_rim.sum() >= 8
    assert np.sqrt(np.mean(ratio[dim] ** 2)) == pytest.approx(1.0, abs=0.01)
    assert np.sqrt(np.mean(ratio[dark_rim] ** 2)) == pytest.approx(1.0, abs=0.1)
    error = (seen.mean(axis=0) - picture) / (deviation / np.sqrt(repeats))
    assert np.abs(error[dim | dark_rim]).max() < 6
    flat = seen[:, unfolded == white]
    assert (flat == detector.full_scale_dn).mean() > 0.99


@pytest.mark.slow
def test_the_bound_is_what_a_fit_of_the_pictures_reaches() -> None:
    """One Gauss-Newton step from the truth on real pictures, its slopes those of the picture."""
    sensor, light = sensor_of(), PRESET.setups["nominal"].irradiance
    pattern = PRESET.fixed_pattern("nominal")
    trials = 600
    one = scene_of([(12.3, -31.7)])
    bound = cramer_rao(sensor, one, pattern, light, PRESET.bound_step_rad)
    assert bound.observable.all()
    irradiance, stray = light.draw(trials, generator("test", "black sun"))
    scene = Scene(
        np.repeat(one.sun, trials, axis=0),
        irradiance,
        stray,
        np.zeros((trials, 2), dtype=np.int64),
    )
    first, second = tangent_axes(one.sun)
    gain = sensor.camera.detector.gain_e_per_dn

    def signals(step: float) -> list[np.ndarray]:
        moves = [(first, 1), (first, -1), (second, 1), (second, -1)]
        turned = [one.sun + sign * step * axis for axis, sign in moves]
        scenes = [replace(one, sun=t / np.linalg.norm(t)) for t in turned]
        scenes.append(replace(one, irradiance=one.irradiance + light.spread))
        scenes.append(replace(one, stray=one.stray + light.stray_spread))
        return [sensor.picture(s, pattern)[0].ravel() for s in scenes]

    mean = sensor.picture(one, pattern)[0].ravel()
    step = 2e-4
    up, down, right, left, bright, hazy = signals(step)
    slopes = np.stack(
        [(up - down) / (2 * step), (right - left) / (2 * step), bright - mean, hazy - mean], axis=1
    )
    weight = gain**2 / sensor.variance(sensor.expected(one, pattern))[0].ravel()
    fisher = slopes.T @ (weight[:, None] * slopes) + np.diag([0, 0, 1.0, 1.0])
    errors = np.zeros((trials, 2))
    for n in range(trials):
        frame = sensor.observe(scene.part(n, n + 1), pattern, NoiseStreams.named("test", "fit", n))[
            0
        ]
        rest = (frame.ravel() - mean) * weight
        errors[n] = np.linalg.solve(fisher, slopes.T @ rest)[:2]
    reached = np.degrees(np.sqrt(np.sum(errors.var(axis=0, ddof=1))))
    assert reached == pytest.approx(bound.angle_deg[0], rel=0.1)
