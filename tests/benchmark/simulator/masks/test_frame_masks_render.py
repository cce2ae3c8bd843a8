"""Shadows of masks of many apertures: a ray count, energy, exact inversion."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from ray_count import centroid, count_rays, dense_suns
from scenes import incident, lit_by

from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.masks.layouts import grid, slit
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

H_MM, PITCH_MM, SIZE = 1.2, 0.012, 96
DETECTOR = PixelArray(
    columns=SIZE,
    rows=SIZE,
    pitch_mm=PITCH_MM,
    sunlit_e=20_000.0,
    full_well_e=30_000.0,
    prnu=0.01,
    dsnu=0.1,
    dark=DarkCurrent(2_000.0),
    exposure_s=0.01,
    read_noise_e=30.0,
    gain_e_per_dn=30.0,
    offset_dn=8.0,
    bits=10,
)
MASKS = {
    "squares": grid(2, 2, 0.4, Aperture("rectangle", 0.15, 0.15)),
    "turned squares": grid(2, 2, 0.4, Aperture("rectangle", 0.15, 0.15, rotation_deg=31.0)),
    "slit": slit(0.05, 0.5),
    "turned slit": slit(0.05, 0.5, 27.0),
    "crossed slits": Mask(
        (
            Aperture("rectangle", 0.04, 0.5, -0.3, 0.0, -8.0),
            Aperture("rectangle", 0.04, 0.4, 0.2, 0.0, 82.0),
        )
    ),
    "thick slit": slit(0.05, 0.5, 27.0, thickness_mm=0.01),
}


def sensor_over(sun: np.ndarray, mask: Mask, **sun_disc) -> MultiSpotSensor:
    """A sensor whose mask is moved so that the light of `sun` falls on the detector's middle."""
    camera = Camera(H_MM, mask, SolarDisc(**sun_disc))
    x, y = camera.spot_mm(sun)[0]
    moved = tuple(replace(a, x_mm=a.x_mm - x, y_mm=a.y_mm - y) for a in mask.apertures)
    moved_mask = replace(mask, apertures=moved)
    return MultiSpotSensor(replace(camera, mask=moved_mask), DETECTOR, spectrum=None)


def light(sensor: MultiSpotSensor, sun: np.ndarray) -> np.ndarray:
    return sensor.lit(lit_by(sun), sensor.fixed_pattern("test"))


def ray_count(sun: np.ndarray, mask: Mask) -> np.ndarray:
    """The whole detector by rays traced one by one."""
    rays, weights = dense_suns(sun, 25)
    way = rays[:, :2] / rays[:, 2:] / PITCH_MM
    openings = np.array(
        [
            (
                *(a.x_mm / PITCH_MM + SIZE / 2, a.y_mm / PITCH_MM + SIZE / 2),
                *(a.width_mm / 2 / PITCH_MM, a.height_mm / 2 / PITCH_MM),
                math.radians(a.rotation_deg),
            )
            for a in mask.apertures
        ]
    )
    rims = (way * (H_MM + sign * mask.thickness_mm / 2) for sign in (-1, 1))
    suns = np.column_stack([*rims, weights * rays[:, 2]])
    return count_rays((SIZE, SIZE), openings, suns, 8, np.random.default_rng(11))


@pytest.mark.slow
@pytest.mark.parametrize("theta", [0.0, 30.0, 60.0])
@pytest.mark.parametrize("name", MASKS)
def test_frames_agree_with_a_ray_count(name: str, theta: float) -> None:
    sun = incident(max(theta, 1e-4), 35.0)
    sensor = sensor_over(sun, MASKS[name])
    frame, reference = light(sensor, sun)[0], ray_count(sun[0], sensor.camera.mask)
    assert np.abs(frame - reference).max() < 5e-3 * reference.max()
    assert np.abs(centroid(frame) - centroid(reference)).max() < 2e-3
    assert frame.sum() == pytest.approx(reference.sum(), rel=1e-3)


@pytest.mark.parametrize("theta", [0.0, 30.0, 60.0])
@pytest.mark.parametrize("name", ["squares", "turned squares", "slit", "turned slit"])
def test_energy_is_area_times_cosine(name: str, theta: float) -> None:
    sun = incident(theta, 20.0)
    sensor = sensor_over(sun, MASKS[name], diameter_deg=0.0)
    area = sum(a.area_mm2 for a in MASKS[name].apertures) / PITCH_MM**2
    total = light(sensor, sun).sum()
    assert total == pytest.approx(area * math.cos(math.radians(theta)), rel=1e-9)


def test_apertures_pass_their_share_and_light_beyond_the_edge_is_lost() -> None:
    up = np.array([[0.0, 0.0, 1.0]])
    sensor = sensor_over(up, MASKS["squares"], diameter_deg=0.0)
    pattern = dict(sensor.fixed_pattern("test"))
    pattern["transmission"] = np.array([1.0, 0.0, 0.25, 0.5])
    frame = sensor.lit(lit_by(up), pattern)[0]
    whole = 0.15**2 / PITCH_MM**2
    quarters = frame.reshape(2, SIZE // 2, 2, SIZE // 2).sum(axis=(1, 3))
    assert quarters.ravel() == pytest.approx(whole * pattern["transmission"], rel=1e-12)
    # half of a square over the detector's edge, and one beyond it
    edge = SIZE / 2 * PITCH_MM
    mask = Mask(
        (Aperture("rectangle", 0.15, 0.15, edge, 0.1), Aperture("round", 0.2, 0.2, 0.2, 2 * edge))
    )
    sensor = MultiSpotSensor(Camera(H_MM, mask, SolarDisc(0.0)), DETECTOR, spectrum=None)
    frame = light(sensor, up)[0]
    assert frame.sum() == pytest.approx(whole / 2, rel=1e-12)
    boxes = sensor.boxes(lit_by(up), sensor.fixed_pattern("test"))[0]
    assert boxes[0, 1] == SIZE
    assert boxes[1, 3] <= boxes[1, 2] or boxes[1, 2] == SIZE


@pytest.mark.parametrize("name", ["squares", "turned slit", "thick slit"])
def test_each_spot_is_what_a_window_around_it_shows(name: str) -> None:
    """Rendering box by box must not lose, add or move light against one large window."""
    sun = from_angles(np.array([11.0, -7.0]), np.array([3.0, 12.0]))
    sensor = sensor_over(sun[:1], MASKS[name])
    glass = CoverGlass((Plate(0.3, 1.5),))
    sensor = replace(sensor, camera=replace(sensor.camera, glass=glass))
    windows = FrameSensor(sensor.camera, DETECTOR, (SIZE, SIZE), 0)
    scene = replace(lit_by(sun), origin_px=np.zeros((2, 2), dtype=np.int64))
    assert light(sensor, sun) == pytest.approx(windows.lit(scene), abs=1e-12)


def test_a_sun_behind_gives_dark_frames() -> None:
    sensor = MultiSpotSensor(Camera(H_MM, MASKS["squares"]), DETECTOR, spectrum=None)
    assert light(sensor, np.array([[0.3, 0.1, -0.9], [1.0, 0.0, 0.0]])).max() == 0.0


def sides(profile: np.ndarray) -> tuple[float, float]:
    """Where a fully sharp, evenly lit box begins and ends, from the share of its edge pixels."""
    full = profile.max()
    inner = np.flatnonzero(profile > full * (1 - 1e-9))
    first, last = inner[0], inner[-1]
    begin = first - profile[:first].sum() / full
    end = last + 1 + profile[last + 1 :].sum() / full
    return begin - 0.5, end - 0.5  # pixel centres are whole numbers


def angles_from_box(frame: np.ndarray, x_mm: float, y_mm: float) -> tuple[float, float]:
    middle = [sum(sides(frame.sum(axis=axis))) / 2 for axis in (0, 1)]
    place = (np.array(middle) - (SIZE - 1) / 2) * PITCH_MM - [x_mm, y_mm]
    beta, alpha = np.degrees(np.arctan(place / H_MM))
    return float(alpha), float(beta)


@pytest.mark.parametrize(("alpha", "beta"), [(0.3, -0.1), (11.0, -14.0), (52.0, 37.0)])
def test_grid_and_slit_are_inverted_exactly(alpha: float, beta: float) -> None:
    """A point Sun, no errors, no noise: the spots' sides give the direction to 1e-6 deg."""
    sun = from_angles(np.array([alpha]), np.array([beta]))
    sensor = sensor_over(sun, MASKS["squares"], diameter_deg=0.0)
    frame = light(sensor, sun)[0]
    for aperture, box in zip(
        sensor.camera.mask.apertures,
        sensor.boxes(lit_by(sun), sensor.fixed_pattern("test"))[0],
        strict=True,
    ):
        alone = np.zeros_like(frame)
        x0, x1, y0, y1 = box
        alone[y0:y1, x0:x1] = frame[y0:y1, x0:x1]
        found = angles_from_box(alone, aperture.x_mm, aperture.y_mm)
        assert found == pytest.approx((alpha, beta), abs=1e-6)
    sensor = sensor_over(sun, MASKS["slit"], diameter_deg=0.0)
    [aperture] = sensor.camera.mask.apertures
    found = angles_from_box(light(sensor, sun)[0], aperture.x_mm, aperture.y_mm)
    assert found == pytest.approx((alpha, beta), abs=1e-6)


def test_turned_slit_is_inverted_exactly_by_its_corners_and_sides() -> None:
    """Below its lowest corner it grows as h^2 / (2 s c); between corners its middle is a line."""
    alpha, beta = 21.0, -33.0
    sun = from_angles(np.array([alpha]), np.array([beta]))
    turn, width, length = 30.0, 0.08, 0.5
    sensor = sensor_over(sun, slit(width, length, turn), diameter_deg=0.0)
    frame = light(sensor, sun)[0] / sun[0, 2]
    [aperture] = sensor.camera.mask.apertures
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    sums = frame.sum(axis=1)
    first, last = np.flatnonzero(sums > 1e-9)[[0, -1]]
    begin = first + 1 - math.sqrt(2 * s * c * sums[first])
    end = last + math.sqrt(2 * s * c * sums[last])
    assert end - begin == pytest.approx((width * s + length * c) / PITCH_MM, rel=1e-9)
    y = (begin + end - 1) / 2
    for row in (SIZE // 2 - 5, SIZE // 2, SIZE // 2 + 7):  # both long sides, no corner
        x = sum(sides(frame[row])) / 2 + math.tan(math.radians(turn)) * (row - y)
        place = (np.array([x, y]) - (SIZE - 1) / 2) * PITCH_MM - [aperture.x_mm, aperture.y_mm]
        assert np.degrees(np.arctan(place / H_MM)) == pytest.approx((beta, alpha), abs=1e-6)


def test_spots_are_where_the_built_mask_puts_them() -> None:
    errors = MaskErrors(position_mm=0.002, size_mm=0.001, edge_mm=0.001)
    sun = from_angles(np.array([5.0]), np.array([-8.0]))
    sensor = replace(sensor_over(sun, MASKS["squares"], diameter_deg=0.0), errors=errors)
    pattern = sensor.fixed_pattern("unit")
    frame = sensor.lit(lit_by(sun), pattern)[0]
    centre = sensor.camera.spot_mm(sun)[0] / sensor.detector.pitch_mm + sensor.detector.centre_px
    spots = centre + pattern["apertures"][:, 1:3]
    for box, spot in zip(sensor.boxes(lit_by(sun), pattern)[0], spots, strict=True):
        x0, x1, y0, y1 = box
        part = np.zeros_like(frame)
        part[y0:y1, x0:x1] = frame[y0:y1, x0:x1]
        middle = [sum(sides(part.sum(axis=axis))) / 2 for axis in (0, 1)]
        assert middle == pytest.approx(spot, abs=1e-9)
