"""Frames, lines and full frames with errors of pixels: the order of the chain, and what stays."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import ndimage

from benchmark import datasets
from benchmark.datasets.conditions.full_frames import for_bound
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.readout.detectors import tunnel_response
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.pixel_errors import PixelErrors
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.lit_pixels import LitPixels

ALL = PixelErrors(
    crosstalk=0.06,
    smear=1e-3,
    hot=0.01,
    nonlinearity=0.02,
    column_offset_e=40.0,
    column_noise_e=25.0,
)
STRAY = 0.01


def sensor_of(name: str, errors: PixelErrors, **more: Any) -> Any:
    """The nominal sensor on a small detector."""
    sensor: Any = datasets.get(name).setups["nominal"].sensor
    size = {"columns": 96, "rows": 96} if hasattr(sensor, "window_px") else {}
    if name == "cmos-encoded":
        size = {"columns": 128, "rows": 128}
    detector = replace(sensor.detector, errors=errors, tunnel=0.0, **size, **more)
    return replace(sensor, detector=detector)


def scene_of(sensor: Any, count: int = 2) -> Scene:
    at = np.linspace(2.0, 3.0, count)
    sun = from_angles(at, -at)
    origin = sensor.origins(sun, np.random.default_rng(1))
    return Scene(sun, np.ones(count), np.full(count, STRAY), origin)


def light_of(sensor: Any, scene: Scene, unit: Any) -> np.ndarray:
    """Light on the pixels, of the sensor without errors, gains and dark signals."""
    plain = replace(sensor, detector=replace(sensor.detector, errors=PixelErrors()))
    even = {**unit, "gain": np.ones_like(unit["gain"]), "dark_e": np.zeros_like(unit["dark_e"])}
    even.pop("column_e", None)
    detector = sensor.detector
    numbers = plain.expected(scene, even) - detector.offset_dn
    return np.asarray(numbers * detector.gain_e_per_dn / detector.sunlit_e)


def windowed(array: np.ndarray, scene: Scene, shape: tuple[int, ...]) -> np.ndarray:
    if scene.origin_px is None:
        return array
    return np.stack([array[y : y + shape[1], x : x + shape[2]] for x, y in scene.origin_px])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cmos-single-aperture", "cmos-encoded"])
def test_frames_go_through_the_chain_in_order(name: str) -> None:
    """Written down anew: light, neighbours, column's light, gain, dark, well, bend, offset."""
    sensor = sensor_of(name, ALL)
    scene, unit = scene_of(sensor), sensor.fixed_pattern("unit")
    detector = sensor.detector
    light = light_of(sensor, scene, unit)
    kernel = np.array([[0, 0.015, 0], [0.015, 0.94, 0.015], [0, 0.015, 0]])
    light = np.stack([ndimage.convolve(one, kernel, mode="nearest") for one in light])
    light += 1e-3 * light.sum(axis=1, keepdims=True)
    gain, dark = (windowed(unit[key], scene, light.shape) for key in ("gain", "dark_e"))
    charge = np.minimum(light * detector.sunlit_e * gain + dark, detector.full_well_e)
    read = charge * (1 - 0.02 * charge / detector.full_well_e)
    first = np.asarray(scene.origin_px)[:, 0]
    columns = np.stack([unit["column_e"][x : x + light.shape[2]] for x in first])
    numbers = detector.offset_dn + (read + columns[:, None]) / detector.gain_e_per_dn
    assert sensor.expected(scene, unit) == pytest.approx(numbers, rel=1e-9)


def test_lines_spill_within_their_array_alone() -> None:
    sensor = sensor_of("pda-slit", replace(ALL, smear=0.0))
    scene, unit = scene_of(sensor), sensor.fixed_pattern("unit")
    detector, columns = sensor.detector, sensor.detector.columns
    light = light_of(sensor, scene, unit).reshape(-1, columns)
    light = ndimage.convolve1d(light, [0.03, 0.94, 0.03], axis=1, mode="nearest").reshape(2, -1)
    charge = light * detector.sunlit_e * unit["gain"] + unit["dark_e"]
    charge = np.minimum(charge, detector.full_well_e)
    read = charge * (1 - 0.02 * charge / detector.full_well_e) + unit["column_e"]
    numbers = detector.offset_dn + read / detector.gain_e_per_dn
    assert sensor.expected(scene, unit) == pytest.approx(numbers, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cmos-single-aperture", "cmos-encoded", "ccd-slit"])
def test_other_draws_stay_when_an_error_is_switched_on(name: str) -> None:
    """A tiny error changes no code but where rounding sat on an edge: no noise is drawn anew."""
    off, on = (sensor_of(name, PixelErrors(column_noise_e=noise)) for noise in (0.0, 1e-6))
    scene, unit = scene_of(off), off.fixed_pattern("unit")
    built = on.fixed_pattern("unit")
    assert all(np.array_equal(unit[key], built[key]) for key in unit)
    codes = off.observe(scene, unit, NoiseStreams.named("noise"))
    again = on.observe(scene, unit, NoiseStreams.named("noise"))
    assert np.count_nonzero(codes != again) <= 3


def test_the_noise_of_a_column_is_its_pixels_own_sum() -> None:
    """In the dark, over frames: a column's mean varies by c^2 + v / H, pixels by c^2 + v."""
    noise_e, frames = 120.0, 200
    sensor = sensor_of("cmos-single-aperture", PixelErrors(column_noise_e=noise_e))
    sensor = replace(sensor, window_jitter_px=0)
    scene = scene_of(sensor, 1)
    scene = Scene(
        np.repeat(scene.sun, frames, 0),
        np.zeros(frames),
        np.zeros(frames),
        np.repeat(scene.origin_px, frames, 0),  # type: ignore[arg-type]
    )
    unit, per_dn = sensor.fixed_pattern("unit"), sensor.detector.gain_e_per_dn
    # the offset is raised, so that no code is clipped
    sensor = replace(sensor, detector=replace(sensor.detector, offset_dn=100.0))
    codes = sensor.observe(scene, unit, NoiseStreams.named("noise")).astype(float)
    rows = codes.shape[1]
    dark = sensor.detector.dark.level() * sensor.detector.exposure_s
    own = (dark + sensor.detector.read_noise_e**2) / per_dn**2 + 1 / 12
    common = (noise_e / per_dn) ** 2
    means = codes.mean(axis=1).var(axis=0, ddof=1).mean()
    # a variance of n frames by W columns: sqrt(2 / (n W)) of itself
    error = 4 * math.sqrt(2 / (frames * codes.shape[2]))
    assert means == pytest.approx(common + own / rows, rel=error)
    assert codes.var(axis=0, ddof=1).mean() == pytest.approx(common + own, rel=error)


def test_full_frames_read_what_is_expected() -> None:
    """Mean of many frames: within 5 standard errors of each pixel's own noise, all but one."""
    errors = replace(ALL, column_noise_e=0.0)
    sensor = sensor_of("cmos-encoded", errors, offset_dn=60.0)
    scene, unit, frames = scene_of(sensor, 1), sensor.fixed_pattern("unit"), 60
    many = Scene(
        np.repeat(scene.sun, frames, 0), np.ones(frames), np.full(frames, STRAY), scene.origin_px
    )
    codes = sensor.observe(many, unit, NoiseStreams.named("noise")).astype(float)
    mean = sensor.expected(scene, unit)
    full = mean > mean.max() - 10  # clipped noise has another mean
    error = np.sqrt(sensor.variance(mean) / frames)
    far = np.abs(codes.mean(axis=0) - mean[0]) / error[0]
    # the converter's rounding has a mean of 0 with noise of a code; of 16,384 normal values 0.01
    # are beyond 5
    assert np.count_nonzero(far[~full[0]] > 5.0) <= 1


def test_references_contain_the_columns_offsets() -> None:
    sensor = sensor_of("cmos-single-aperture", PixelErrors(column_offset_e=200.0))
    sensor = replace(sensor, detector=replace(sensor.detector, offset_dn=60.0))
    unit = sensor.fixed_pattern("unit")
    dark = sensor.reference_readings(unit, References(), NoiseStreams.named("dark"))["dark_dn"]
    found = dark.mean(axis=0) - 60.0 - unit["dark_e"].mean(axis=0) / sensor.detector.gain_e_per_dn
    single = math.sqrt(920.0 / 30.0**2 + 1 / 12) / math.sqrt(16 * 96)
    assert found == pytest.approx(unit["column_e"] / 30.0, abs=5 * single)


@pytest.mark.parametrize(
    "errors", [ALL, replace(ALL, smear=0.0, column_noise_e=0.0, column_offset_e=0.0)]
)
def test_lit_pixels_are_those_of_the_frame(errors: PixelErrors) -> None:
    """Near light every pixel; elsewhere the mean of each column, or of all."""
    sensor = for_bound(sensor_of("cmos-encoded", errors))
    scene, unit = scene_of(sensor, 1), sensor.fixed_pattern("unit")
    lit = LitPixels(sensor, scene, unit)
    brighter = replace(scene, stray=scene.stray + 0.01)
    for seen in (scene, brighter):
        frame = sensor.expected(seen, unit)[0]
        found = lit.expected(seen, unit)[0]
        pixels = lit._pixels[0]
        assert found[: len(pixels)] == pytest.approx(frame.ravel()[pixels], rel=1e-7)
        rest = np.ones(frame.size, dtype=bool)
        rest[pixels] = False
        held = np.where(rest, frame.ravel(), 0.0).reshape(frame.shape)
        each = (lambda a: a.sum(axis=0)) if lit._means > 1 else np.sum
        mean = each(held) / each(rest.reshape(frame.shape))
        # a mean is bent once, not pixel by pixel: hot ones bend more
        assert found[len(pixels) :] == pytest.approx(mean, rel=2e-3)


def test_oblique_light_falls_on_the_walls_of_a_tunnel() -> None:
    """Rays drawn over the mouth of a tunnel: the share of those that reach its floor."""
    mouth = (np.arange(100_000) + 0.5) / 100_000
    for angle in (0.0, 20.0, 45.0, 60.0, 89.0):
        inside = math.asin(math.sin(math.radians(angle)) / 1.46)
        reach = np.mean(mouth + 0.4 * math.tan(inside) <= 1.0)
        found = tunnel_response(np.array([math.cos(math.radians(angle))]), 0.4)[0]
        assert found == pytest.approx(reach, abs=2e-5)


@pytest.mark.parametrize("name", ["cmos-single-aperture", "ccd-slit", "cmos-encoded"])
def test_tunnels_dim_the_sun_and_no_stray_light(name: str) -> None:
    plain = sensor_of(name, PixelErrors())
    deep = replace(plain, detector=replace(plain.detector, tunnel=0.5))
    scene, unit = scene_of(plain, 1), plain.fixed_pattern("unit")
    assembly = plain.camera.assembly
    share = tunnel_response(assembly.to_head(scene.sun)[:, 2], 0.5)[0]
    dark = replace(scene, irradiance=np.zeros(1))
    background = plain.expected(dark, unit)
    assert deep.expected(dark, unit) == pytest.approx(background)
    direct = plain.expected(scene, unit) - background
    assert deep.expected(scene, unit) - background == pytest.approx(share * direct, abs=1e-8)


@pytest.mark.parametrize("name", ["cmos-single-aperture", "ccd-slit", "cmos-encoded"])
def test_stray_light_adds_its_share_of_a_sunlit_pixel_to_every_pixel(name: str) -> None:
    sensor = sensor_of(name, PixelErrors())
    dark = replace(scene_of(sensor, 1), irradiance=np.zeros(1))
    unit, detector = sensor.fixed_pattern("unit"), sensor.detector
    dim, bright = (
        sensor.expected(replace(dark, stray=np.full(1, stray)), unit)[0] for stray in (0.01, 0.03)
    )
    shares = (bright - dim) * detector.gain_e_per_dn / (0.02 * detector.sunlit_e)
    assert shares.min() > 0.8
    assert shares.mean() == pytest.approx(1.0, abs=0.01)  # gains scatter about one
