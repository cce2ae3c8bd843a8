"""Light of the sunlit Earth through openings: closed forms, other quadratures, counted rays."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bare_pixels import bare
from shadows import shadows

from benchmark import datasets
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Earth, uniform_direction
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.masks.layouts import grid
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.earthlight import EarthInView, Points, on_points
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import CurrentReadout, Quadrants
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.simulator.sensors.lit_pixels import LitPixels
from benchmark.simulator.sensors.quadrants import QuadrantSensor
from benchmark.sweeps.albedo_influence import aperture_earthlight, lit_patches

IDEAL = CurrentReadout(100.0, 0.0, 0.0, full_scale_ua=200.0, bits=24)
POINT = SolarDisc(diameter_deg=0.0)
#: A metre above the ground: it fills all there is below, and is lit alike as far as one can see.
WALL = Earth(altitude_km=0.001)
AHEAD, BEHIND = np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, -1.0]])


def quadrants(half_width_mm: float, gap_mm: float = 0.0) -> QuadrantSensor:
    mask = Mask((Aperture("rectangle", 2.0, 2.0),))
    return QuadrantSensor(Camera(1.0, mask, POINT), Quadrants(half_width_mm, gap_mm), IDEAL)


def seen(sensor: QuadrantSensor, earth: Earth, nadir: np.ndarray, sun: np.ndarray) -> np.ndarray:
    scene = Scene(sun, np.ones(len(sun)), np.zeros(len(sun)))
    return sensor.earth_through(earth, nadir, scene, sensor.fixed_pattern("test"))


def somewhere(count: int, earth: Earth, *names: str) -> tuple[np.ndarray, np.ndarray]:
    """Suns within 40 deg of the boresight, and nadirs."""
    stream = generator("test", *names)
    suns: list[tuple[float, float, float]] = []
    while len(suns) < count:
        one = uniform_direction(stream)
        if one[2] > math.cos(math.radians(40.0)):
            suns.append(one)
    sun = np.array(suns)
    return sun, earth.draw_nadir(sun, stream)


def test_a_small_hole_shows_an_even_wall_with_the_fourth_power_of_the_cosine() -> None:
    hole = Mask((Aperture("round", 0.01, 0.01),))
    points = Points(np.array([[-2.0, -2.0]]), (0.5, 0.5), 9, 9)
    view = EarthInView(WALL, AHEAD, BEHIND)
    found = on_points(Camera(1.0, hole, POINT), points, view, rays=1)[0]
    x, y = np.meshgrid(np.arange(-2.0, 2.1, 0.5), np.arange(-2.0, 2.1, 0.5))
    cosine = 1.0 / np.sqrt(1.0 + x**2 + y**2)
    # the table's steps of 5.6 um leave (5.6e-3)^2 / 8 of a second derivative of 4 at most
    assert found == pytest.approx(0.3 / math.pi * math.pi * 0.005**2 * cosine**4, rel=1.6e-5)


def test_all_of_a_hemisphere_through_an_opening_is_pi_times_its_radiance() -> None:
    """Detector of 1 m below a hole 1 mm up: what misses it comes from within 0.1 deg of grazing."""
    found = seen(quadrants(500.0), WALL, AHEAD, BEHIND)
    # the horizon of a metre's height dips by 0.03 deg
    assert found.sum() == pytest.approx(0.3, rel=2e-4)
    assert found[0] == pytest.approx(found.sum() / 4.0, rel=1e-3)


def test_an_earth_straight_ahead_and_lit_from_behind_moves_no_balance() -> None:
    q1, q2, q3, q4 = seen(quadrants(1.8), Earth(), AHEAD, BEHIND)[0]
    assert q1 + q2 + q3 + q4 > 0.1
    assert [q2 + q3 - q1 - q4, q1 + q2 - q3 - q4] == pytest.approx([0.0, 0.0], abs=1e-5)


def test_quadrants_see_what_patches_of_the_earth_throw_on_them() -> None:
    """Another quadrature: patches fixed to the Earth instead of to the sky; areas by intervals."""
    earth, sensor = Earth(), quadrants(1.8, 0.05)
    sun, nadir = somewhere(12, earth, "patches")
    expected = np.zeros((12, 4))
    for n in range(12):
        patches = lit_patches(earth, sun[n], nadir[n], 200, 600)
        s = patches.directions[patches.directions[:, 2] > 1e-3]
        light = patches.light[patches.directions[:, 2] > 1e-3] * s[:, 2] / 4.0
        x, y = s[:, 0] / s[:, 2], s[:, 1] / s[:, 2]
        for k, (left, right, low, high) in enumerate(sensor.detector.boxes()):
            across = np.minimum(right, x + 1.0) - np.maximum(left, x - 1.0)
            along = np.minimum(high, y + 1.0) - np.maximum(low, y - 1.0)
            expected[n, k] = np.sum(light * np.maximum(across, 0.0) * np.maximum(along, 0.0))
    # what the sky's nodes promise: within 0.5 % of what an Earth in full view gives
    full = seen(sensor, earth, AHEAD, BEHIND).max()
    assert seen(sensor, earth, nadir, sun) == pytest.approx(expected, abs=0.005 * full)


def wide_frame() -> FrameSensor:
    sensor = datasets.get("cmos-single-aperture").setups["nominal"].sensor
    assert isinstance(sensor, FrameSensor)
    camera = replace(sensor.camera, assembly=Assembly(), mask=Mask((Aperture("round", 0.2, 0.2),)))
    return shadows(sensor, camera=camera, detector=bare(sensor.detector))


def frame_of(sensor: FrameSensor, earth: Earth, nadir: np.ndarray, sun: np.ndarray, at: list[int]):
    scene = Scene(sun[None], np.ones(1), np.zeros(1), np.array([at]))
    pattern = {"gain": np.ones((512, 512)), "dark_e": np.zeros((512, 512))}
    lit = replace(scene, albedo=sensor.earth_through(earth, nadir[None], scene, pattern))
    difference = sensor.expected(lit, pattern) - sensor.expected(scene, pattern)
    return difference[0] * sensor.detector.gain_e_per_dn / sensor.detector.sunlit_e


def limb_in_the_window() -> tuple[np.ndarray, np.ndarray, list[int]]:
    nadir = np.array([math.sin(math.radians(60)), 0.0, math.cos(math.radians(60))])
    return nadir, np.array([-0.8, 0.0, 0.6]), [256, 224]


def test_frames_see_what_patches_of_the_earth_throw_on_them() -> None:
    sensor, earth = wide_frame(), Earth()
    nadir, sun, at = limb_in_the_window()
    found = frame_of(sensor, earth, nadir, sun, at)
    expected = aperture_earthlight(sensor, lit_patches(earth, sun, nadir, 128, 384), np.array(at))
    assert expected.max() > 5e-4
    difference = (found - expected) / expected.max()
    assert math.sqrt(np.mean(difference**2)) < 0.01


def test_arrays_along_both_axes_see_the_earth_from_their_own_side() -> None:
    """Mirrored about x = y, what the array along x saw the one along y sees."""
    sensor = datasets.get("ccd-slit").setups["nominal"].sensor
    assert sensor.axes == ("x", "y")
    sensor = replace(sensor, camera=replace(sensor.camera, assembly=Assembly()))
    nadir, sun = np.array([[0.8, 0.1, 0.59]]), np.array([[-0.8, 0.2, 0.56]])
    ones = np.ones(1), np.zeros(1)
    first = sensor.earth_through(Earth(), nadir, Scene(sun, *ones), {})
    other = sensor.earth_through(Earth(), nadir[:, [1, 0, 2]], Scene(sun[:, [1, 0, 2]], *ones), {})
    assert first[:, 0].max() > 0
    assert other[:, ::-1] == pytest.approx(first, rel=1e-9)
    assert not np.allclose(first[:, 0], first[:, 1])


def test_thick_foil_takes_the_share_its_walls_shade() -> None:
    """A wall in front through a square hole of width w, foil t: ``1 - t tan(theta) / w``."""
    points = Points(np.array([[0.0, 0.0]]), (0.5, 0.5), 1, 4)
    view = EarthInView(WALL, AHEAD, BEHIND)
    thin, thick = (
        on_points(Camera(1.0, Mask((Aperture("rectangle", 0.1, 0.1),), t), POINT), points, view, 1)
        for t in (0.0, 0.02)
    )
    tangent = np.array([0.0, 0.5, 1.0, 1.5])
    assert thick[0, 0] / thin[0, 0] == pytest.approx(1.0 - 0.02 * tangent / 0.1, abs=1e-5)


def test_full_frames_behind_many_holes_have_the_earth_in_every_way_they_are_made() -> None:
    """`expected`, what is read out, and the pixels that bounds are of, agree."""
    preset = datasets.get("cmos-multi-aperture")
    whole: Any = preset.setups["nominal"].sensor
    mask = grid(3, 3, 0.833, Aperture("round", 0.1, 0.1), thickness_mm=0.01)
    # amplifiers bent by no charge: what they show of a mean is the mean of what they show
    straight = replace(whole.detector.errors, nonlinearity=0.0)
    detector = replace(whole.detector, columns=320, rows=320, errors=straight)
    camera = replace(whole.camera, mask=mask)
    sensor = replace(whole, camera=camera, detector=detector, spectrum=None)
    pattern = sensor.fixed_pattern("test")
    plain = preset.scene("nominal", "test").part(0, 2)
    nadir = np.array([[0.1, 0.2, 0.97], [-0.3, 0.1, 0.95]])
    nadir /= np.linalg.norm(nadir, axis=1, keepdims=True)
    # the Sun behind: all ground in view is lit
    view = replace(plain, sun=-nadir)
    light = sensor.earth_through(Earth(), nadir, view, pattern)
    assert light.max() > 1e-4
    scene = replace(plain, albedo=light)
    dark, bright = sensor.expected(plain, pattern), sensor.expected(scene, pattern)
    assert (bright - dark).min() >= 0
    streams = (NoiseStreams.named("test", "frames") for _ in range(2))
    read = [sensor.observe(one, pattern, next(streams)).astype(float) for one in (plain, scene)]
    change = (read[1] - read[0]).mean(axis=(1, 2))
    # the same noise in both, rounding apart; a full pixel stays as it was
    assert change == pytest.approx((bright - dark).mean(axis=(1, 2)), rel=0.02)
    near = LitPixels(sensor, scene, pattern)
    kept = near.expected(scene, pattern)
    for n in range(2):
        mine = near._pixels[n][near._pixels[n] >= 0]
        assert kept[n, : len(mine)] == pytest.approx(bright[n].ravel()[mine], rel=1e-7)
        # columns have amplifiers of their own, and a mean of the other pixels each
        others = bright[n].copy()
        others.ravel()[mine] = np.nan
        assert kept[n, -320:] == pytest.approx(np.nanmean(others, axis=0), rel=1e-9)
