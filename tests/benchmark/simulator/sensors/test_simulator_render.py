"""Rendered frames against an independent, dense ray count that shares no code with them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bare_pixels import bare
from numba import njit
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


def incident(theta_deg: float, azimuth_deg: float) -> np.ndarray:
    theta, azimuth = math.radians(theta_deg), math.radians(azimuth_deg)
    across = math.sin(theta)
    return np.array([[across * math.cos(azimuth), across * math.sin(azimuth), math.cos(theta)]])


@njit
def _depth(x, y, rim):
    """How far inside an aperture a point lies, in pixels; negative outside."""
    is_round, half_w, half_h, turn = rim
    if is_round:
        return half_w - math.sqrt(x * x + y * y)
    c, s = math.cos(turn), math.sin(turn)
    return min(half_w - abs(c * x + s * y), half_h - abs(c * y - s * x))


@njit
def _count_rays(corner, suns, rim, sub, rng):
    """For every pixel, the share of randomly jittered rays that pass both rims, over the Sun."""
    frame = np.zeros((SIZE, SIZE))
    for k in range(suns.shape[0]):
        low_x, low_y, up_x, up_y, weight = suns[k]
        for row in range(SIZE):
            for column in range(SIZE):
                x, y = corner[0] + column + 0.5, corner[1] + row + 0.5
                depth = min(_depth(x - low_x, y - low_y, rim), _depth(x - up_x, y - up_y, rim))
                if abs(depth) > 0.75:  # farther from every rim than half a pixel's diagonal
                    frame[row, column] += weight * (depth > 0)
                    continue
                hits = 0
                for i in range(sub * sub):
                    x = corner[0] + column + (i % sub + rng.random()) / sub
                    y = corner[1] + row + (i // sub + rng.random()) / sub
                    hits += (
                        _depth(x - low_x, y - low_y, rim) > 0
                        and _depth(x - up_x, y - up_y, rim) > 0
                    )
                frame[row, column] += weight * hits / sub**2
    return frame


def dense_ray_count(
    sun: np.ndarray, origin: np.ndarray, aperture: Aperture, thickness: float, glass: Any
) -> np.ndarray:
    """Irradiance per pixel from rays traced one by one: Sun on a grid, angles, no shared code."""
    radius, cells = math.radians(0.533 / 2), 31
    grid = (np.arange(cells) + 0.5) / cells * 2 - 1
    u, v = (axis.ravel() for axis in np.meshgrid(grid, grid))
    keep = u**2 + v**2 <= 1
    u, v = u[keep], v[keep]
    weight = 1 - 0.6 * (1 - np.sqrt(1 - u**2 - v**2))
    weight /= weight.sum()
    up = np.array([0.0, 1.0, 0.0])
    e1 = np.cross(up, sun)
    e1 /= np.linalg.norm(e1)
    e2 = np.cross(sun, e1)
    rays = sun + np.sin(radius) * (u[:, None] * e1 + v[:, None] * e2)
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    theta, azimuth = np.arccos(rays[:, 2]), np.arctan2(rays[:, 1], rays[:, 0])
    inner = np.arcsin(np.sin(theta) / glass[1]) if glass else theta
    depth = glass[0] if glass else 0.0
    passed = np.ones_like(theta)
    if glass:
        rs = (np.sin(theta - inner) / np.sin(theta + inner)) ** 2
        rp = (np.tan(theta - inner) / np.tan(theta + inner)) ** 2
        passed = ((1 - rs) ** 2 + (1 - rp) ** 2) / 2
    low = (H_MM - thickness / 2 - depth) * np.tan(theta) + depth * np.tan(inner)
    high = low + thickness * np.tan(theta)
    direction = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
    suns = np.column_stack(
        [
            low[:, None] * direction / PITCH_MM,
            high[:, None] * direction / PITCH_MM,
            weight * np.cos(theta) * passed,
        ]
    )
    rim = (
        aperture.shape == "round",
        aperture.width_mm / 2 / PITCH_MM,
        aperture.height_mm / 2 / PITCH_MM,
        math.radians(aperture.rotation_deg),
    )
    return _count_rays(origin - 255.5 - 0.5, suns, rim, 12, np.random.default_rng(7))


def centroid(frame: np.ndarray) -> np.ndarray:
    y, x = np.mgrid[: frame.shape[0], : frame.shape[1]]
    return np.array([(frame * x).sum(), (frame * y).sum()]) / frame.sum()


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
