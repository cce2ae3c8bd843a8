"""Rendered frames against an independent, dense ray count that shares no code with them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bare_pixels import bare
from ray_count import centroid, count_rays, dense_suns
from scenes import incident
from shadows import shadows

from benchmark import datasets
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.frames import FrameSensor

H_MM, PITCH_MM, SIZE = 1.2, 0.012, 48
APERTURES = {
    "round": Aperture("round", 0.2, 0.2),
    "square": Aperture("rectangle", 0.18, 0.18, rotation_deg=12.0),
    "slit": Aperture("rectangle", 0.03, 0.3),
}


def sensor_with(
    aperture: Aperture, thickness: float = 0.0, glass: CoverGlass | None = None, **sun: Any
) -> FrameSensor:
    nominal = datasets.get("cmos-single-aperture").setups["nominal"].sensor
    mask = Mask((aperture,), thickness)
    camera = Camera(H_MM, mask, SolarDisc(**sun), glass or CoverGlass())
    detector = replace(bare(nominal.detector), pitch_mm=PITCH_MM)
    return shadows(nominal, camera=camera, window_px=(SIZE, SIZE), detector=detector)


def scene_of(sensor: FrameSensor, sun: np.ndarray) -> Scene:
    origin = np.rint(sensor.spot_px(sun)).astype(np.int64) - SIZE // 2
    return Scene(sun, np.ones(len(sun)), np.zeros(len(sun)), origin)


def dense_ray_count(
    sun: np.ndarray, origin: np.ndarray, aperture: Aperture, thickness: float, glass: Any
) -> np.ndarray:
    """Irradiance per pixel from rays traced one by one, through glass by Snell and Fresnel."""
    rays, weights = dense_suns(sun, 31)
    theta, azimuth = np.arccos(rays[:, 2]), np.arctan2(rays[:, 1], rays[:, 0])
    inner = np.arcsin(np.sin(theta) / glass[1]) if glass else theta
    depth = glass[0] if glass else 0.0
    passed = np.ones_like(theta)
    if glass:
        rs = (np.sin(theta - inner) / np.sin(theta + inner)) ** 2
        rp = (np.tan(theta - inner) / np.tan(theta + inner)) ** 2
        passed = ((1 - rs) ** 2 + (1 - rp) ** 2) / 2
    low = (H_MM - thickness / 2 - depth) * np.tan(theta) + depth * np.tan(inner)
    direction = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1) / PITCH_MM
    far = (low, low + thickness * np.tan(theta))
    rims = (one[:, None] * direction for one in far)
    suns = np.column_stack([*rims, weights * np.cos(theta) * passed])
    half_mm = (aperture.width_mm / 2, 0.0 if aperture.shape == "round" else aperture.height_mm / 2)
    middle, half = 256.0 - origin, np.array(half_mm) / PITCH_MM
    opening = np.array([[*middle, *half, math.radians(aperture.rotation_deg)]])
    return count_rays((SIZE, SIZE), opening, suns, 12, np.random.default_rng(7))


@pytest.mark.slow
@pytest.mark.parametrize("theta", [0.0, 30.0, 60.0])
@pytest.mark.parametrize("shape", ["round", "square", "slit"])
@pytest.mark.parametrize(
    ("share", "glass"), [(0.0, None), (0.25, None), (0.0, (0.5, 1.52))], ids=str
)
def test_frames_agree_with_a_dense_ray_count(
    shape: str, theta: float, share: float, glass: tuple[float, float] | None
) -> None:
    # just off the axis for "0 deg": the reference's Fresnel formula divides by sin(theta)
    sun = incident(max(theta, 1e-4), 35.0)
    thickness = share * APERTURES[shape].width_mm
    sensor = sensor_with(APERTURES[shape], thickness, CoverGlass((Plate(*glass),) if glass else ()))
    scene = scene_of(sensor, sun)
    rendered = sensor.lit(scene)[0]
    assert scene.origin_px is not None
    reference = dense_ray_count(sun[0], scene.origin_px[0], APERTURES[shape], thickness, glass)
    worst = np.abs(rendered - reference).max() / reference.max()
    off = np.abs(centroid(rendered) - centroid(reference)).max()
    assert worst < 5e-3
    assert off < 2e-3
    assert rendered.sum() == pytest.approx(reference.sum(), rel=1e-3)


@pytest.mark.parametrize("theta", [0.0, 30.0, 60.0])
@pytest.mark.parametrize("shape", ["round", "square", "slit"])
def test_light_through_a_thin_mask_is_aperture_area_times_cosine(shape: str, theta: float) -> None:
    sensor = sensor_with(APERTURES[shape], diameter_deg=0.0)
    frame = sensor.lit(scene_of(sensor, incident(theta, 20.0)))[0]
    area = APERTURES[shape].area_mm2 / PITCH_MM**2
    assert frame.sum() == pytest.approx(area * math.cos(math.radians(theta)), rel=1e-9)
    assert frame.max() <= math.cos(math.radians(theta)) * (1 + 1e-12)


@pytest.mark.parametrize("ratio", [0.1, 0.5, 0.9, 1.1])
def test_thick_round_mask_passes_the_intersection_of_two_discs(ratio: float) -> None:
    diameter, thickness = 0.2, 0.1
    theta = math.degrees(math.atan(ratio * diameter / thickness))
    sensor = sensor_with(Aperture("round", diameter, diameter), thickness, diameter_deg=0.0)
    camera = replace(sensor.camera, focal_length_mm=0.3)
    sensor = replace(sensor, camera=camera)
    frame = sensor.lit(scene_of(sensor, incident(theta, 50.0)))[0]
    r, d = diameter / 2, min(ratio, 1.0) * diameter
    lens = 2 * r * r * math.acos(d / (2 * r)) - d / 2 * math.sqrt(max(4 * r * r - d * d, 0.0))
    expected = lens / PITCH_MM**2 * math.cos(math.radians(theta))
    assert frame.sum() == pytest.approx(expected, rel=1e-9, abs=1e-9)
    if ratio < 1:
        # the lens is centred on the ray through the middle of the aperture
        scene = scene_of(sensor, incident(theta, 50.0))
        assert scene.origin_px is not None
        spot = sensor.spot_px(scene.sun)[0] - scene.origin_px[0]
        assert centroid(frame) == pytest.approx(spot, abs=2e-3)


def test_pinhole_spot_falls_at_h_tan_of_the_projection_angles() -> None:
    sensor = sensor_with(APERTURES["round"], diameter_deg=0.0)
    alpha, beta = np.array([-50.0, 0.0, 12.0, 59.0]), np.array([20.0, -33.0, 0.0, 59.0])
    scene = scene_of(sensor, from_angles(alpha, beta))
    assert scene.origin_px is not None
    for frame, origin, a, b in zip(sensor.lit(scene), scene.origin_px, alpha, beta, strict=True):
        x, y = (centroid(frame) + origin - 255.5) * PITCH_MM
        assert x == pytest.approx(H_MM * math.tan(math.radians(b)), abs=2e-3 * PITCH_MM)
        assert y == pytest.approx(H_MM * math.tan(math.radians(a)), abs=2e-3 * PITCH_MM)


def test_solar_disc_stretches_the_spot_radially_more_than_tangentially() -> None:
    """Half-widths h/cos^2 and h/cos: variances add 1/cos^4 and 1/cos^2 of the Sun's."""
    spread = {}
    for theta in (0.0, 60.0):
        sun = incident(theta, 0.0)
        wide, point = (sensor_with(APERTURES["round"], diameter_deg=d) for d in (3.0, 0.0))
        moments = []
        for sensor in (wide, point):
            frame = sensor.lit(scene_of(sensor, sun))[0]
            share = frame / frame.sum()
            y, x = np.mgrid[:SIZE, :SIZE]
            cx, cy = centroid(frame)
            moments.append([(share * (x - cx) ** 2).sum(), (share * (y - cy) ** 2).sum()])
        spread[theta] = np.subtract(*moments)
    assert spread[60.0][0] / spread[0.0][0] == pytest.approx(16.0, rel=0.03)
    assert spread[60.0][1] / spread[0.0][1] == pytest.approx(4.0, rel=0.03)


def test_a_window_without_origin_or_outside_the_detector_is_refused() -> None:
    sensor = sensor_with(APERTURES["round"])
    sun = np.array([[0.0, 0.0, 1.0]])
    pattern = sensor.fixed_pattern("test")
    with pytest.raises(ValueError, match="origin_px is None"):
        sensor.expected(Scene(sun, np.ones(1), np.zeros(1)), pattern)
    with pytest.raises(ValueError, match=r"512.*512"):
        sensor.expected(Scene(sun, np.ones(1), np.zeros(1), np.array([[-1, 0]])), pattern)
