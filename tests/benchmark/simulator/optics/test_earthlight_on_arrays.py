"""The sunlit Earth on linear arrays, full frames and event arrays; stray light that slopes."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scenes import lit_by, nominal

from benchmark import datasets
from benchmark.datasets.conditions.flight import FlightPreset
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.light.stray_slope import UnevenScene
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.layouts import grid
from benchmark.simulator.masks.slits import slit_row
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.pixel_errors import PixelErrors
from benchmark.simulator.sensor import SeesEarth
from benchmark.simulator.sensors.events import EventSensor
from benchmark.simulator.sensors.lit_pixels import LitPixels

POINT = SolarDisc(diameter_deg=0.0)
#: A metre above the ground: it fills all there is below, and is lit alike as far as one can see.
WALL = Earth(altitude_km=0.001)
AHEAD, BEHIND = np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, -1.0]])


def radiance(sight: np.ndarray, nadir: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """Of rays (P, 3): where each meets a sphere, in kilometres, and how the Sun stands there."""
    earth = Earth()
    centre = (earth.radius_km + earth.altitude_km) * nadir
    along = sight @ centre
    rest = along**2 - centre @ centre + earth.radius_km**2
    near = along - np.sqrt(np.maximum(rest, 0.0))
    up = (near[:, None] * sight - centre) / earth.radius_km
    lit = earth.reflectance / math.pi * np.maximum(up @ sun, 0.0)
    return np.where((rest > 0) & (along > 0), lit, 0.0)


def through(place_mm: np.ndarray, rays_mm: np.ndarray, height_mm: float) -> tuple[Any, Any]:
    """Lines of sight (P, 3) from a place through points of the mask, and ``cos^4 / h^2``."""
    sight = np.column_stack([place_mm - rays_mm, np.full(len(rays_mm), height_mm)])
    distance2 = np.sum(sight**2, axis=1)
    sight /= np.sqrt(distance2)[:, None]
    return sight, sight[:, 2] ** 2 / distance2


def test_a_wall_through_a_slit_falls_off_as_a_strips_view_factor() -> None:
    """Of width w and length l, at u below it: ``L w h^2`` times the integral of ``1 / r^4``.

    ``(l / 2) / (R^2 (R^2 + l^2 / 4)) + atan(l / (2 R)) / R^3`` with ``R^2 = h^2 + u^2``.
    """
    width, length, height = 0.01, 4.0, 1.0
    sensor = nominal("ccd-slit")
    camera = Camera(height, slit_row((0.0,), width, length), POINT)
    sensor = replace(sensor, camera=camera, axes=("x",))
    found = sensor.earth_through(WALL, AHEAD, lit_by(BEHIND), {})[0, 0]
    reach = 1023 * sensor.detector.pitch_mm / 2.0
    r2 = height**2 + np.linspace(-reach, reach, len(found)) ** 2
    strip = (length / 2.0) / (r2 * (r2 + length**2 / 4.0))
    strip += np.arctan(length / (2.0 * np.sqrt(r2))) / r2**1.5
    # 64 points along the slit: the midpoint rule's error is (l / 64)^2 / 24 of the second
    # derivative, 4 / R^2 of the value at most: 7e-4; the slit's width is small beside R
    assert found == pytest.approx(0.3 / math.pi * width * height**2 * strip, rel=7e-4)


@pytest.mark.slow
def test_an_array_counts_the_rays_that_reach_its_pixels() -> None:
    """From a pixel's area to points of the slit: radiance ``cos^4 / h^2 dA``.

    Limbs on the array; 40,000 rays a pixel have standard errors of some per cent of its light.
    """
    sensor, count = nominal("pda-slit"), 40_000
    sensor = replace(sensor, camera=replace(sensor.camera, assembly=Assembly()))
    foil = sensor.camera.mask.thickness_mm
    nadir = np.array([[0.6, 0.1, 0.79], [-0.5, 0.6, 0.62]])
    nadir /= np.linalg.norm(nadir, axis=1, keepdims=True)
    sun = np.array([[-0.95, 0.1, 0.3], [0.7, -0.6, 0.4]])
    sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    scene, pattern = lit_by(sun), sensor.fixed_pattern("test")
    lit = replace(scene, albedo=sensor.earth_through(Earth(), nadir, scene, pattern))
    added = sensor._electrons(lit, pattern) - sensor._electrons(scene, pattern)
    light = added / (sensor.detector.sunlit_e * pattern["gain"])
    (slit,) = sensor.camera.mask.apertures
    half = np.array([slit.width_mm, slit.height_mm]) / 2.0
    height, pitch = sensor.camera.height_mm, sensor.detector.pitch_mm
    rng = np.random.default_rng(19)
    for n in range(2):
        off, errors = [], []
        for pixel in range(8, 256, 16):
            place = np.column_stack(
                [
                    (pixel - 127.5 + rng.uniform(-0.45, 0.45, count)) * pitch,
                    rng.uniform(-0.5, 0.5, count) * sensor.pixel_height_mm,
                ]
            )
            rays = rng.uniform(-1.0, 1.0, (count, 2)) * half
            sight, weight = through(place, rays, height)
            # both rims of the foil must let the ray pass
            shear = foil / 2.0 * sight[:, :2] / sight[:, 2:]
            passed = (np.abs(rays + shear) <= half).all(1) & (np.abs(rays - shear) <= half).all(1)
            each = radiance(sight, nadir[n], sun[n]) * weight * passed * slit.area_mm2
            off.append(light[n, pixel] - each.mean())
            errors.append(each.std() / math.sqrt(count))
        # between points, and over 64 rays: within 1 % of the brightest, root mean square
        expected = np.sqrt(np.mean(np.square(errors)) + (0.01 * light[n].max()) ** 2)
        assert math.sqrt(np.mean(np.square(off))) < 1.5 * expected
        assert light[n].max() > 1e-3


@pytest.mark.slow
def test_a_full_frame_counts_the_rays_through_all_its_holes() -> None:
    """From a pixel's centre to points of any hole; standard errors of 100,000 rays are stated."""
    sensor, count = replace(nominal("ccd-multi-aperture"), spectrum=None), 100_000
    sensor = replace(sensor, camera=replace(sensor.camera, assembly=Assembly()))
    nadir, sun = np.array([[0.6, 0.2, 0.77]]), np.array([[-0.95, 0.1, 0.3]])
    nadir, sun = nadir / np.linalg.norm(nadir), sun / np.linalg.norm(sun)
    scene = lit_by(sun)
    frame = np.zeros((1, 512, 512))
    nodes = sensor.earth_through(Earth(), nadir, scene, {})
    sensor.add_uneven(frame, replace(scene, albedo=nodes))
    apertures = sensor.camera.mask.apertures
    middles = np.array([(a.x_mm, a.y_mm) for a in apertures])
    open_mm2 = sum(a.area_mm2 for a in apertures)
    rng = np.random.default_rng(23)
    for column, row in [(40, 40), (256, 256), (300, 100), (450, 256), (480, 470)]:
        radius, turn = 0.025 * np.sqrt(rng.random(count)), math.tau * rng.random(count)
        rays = middles[rng.integers(0, len(middles), count)]
        rays = rays + np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])
        place = (np.array([column, row]) - 255.5) * sensor.detector.pitch_mm
        sight, weight = through(place, rays, sensor.camera.height_mm)
        each = radiance(sight, nadir[0], sun[0]) * weight * open_mm2
        error = each.std() / math.sqrt(count)
        assert error < 0.01 * frame.max()
        assert abs(frame[0, row, column] - each.mean()) < 4.0 * error + 0.01 * frame.max()
    assert frame.max() > 5e-4


def test_events_come_as_much_earlier_as_the_earth_adds_to_the_current(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One over the time to fire is proportional to photo and dark current; here without a Sun."""
    monkeypatch.setattr(EventSensor, "_render", lambda _, sun: np.zeros((len(sun), 64, 64)))
    sensor = nominal("event-single-aperture")
    sun = np.array([[0.1, -0.2, 0.97]]) / math.sqrt(0.1**2 + 0.2**2 + 0.97**2)
    scene, pattern = lit_by(sun), sensor.fixed_pattern("test")
    nodes = sensor.earth_through(Earth(), sun, replace(scene, sun=-sun), pattern)
    even = np.full_like(nodes, 1e-3)
    assert nodes.max() > 5e-4  # a hole of 0.1 mm 0.6 mm up: 0.3 (0.05 / 0.6)^2 at most
    assert nodes.max() < 0.3 * (0.05 / 0.6) ** 2
    dark, lit = (
        1.0 / sensor.expected(replace(scene, albedo=light), pattern)[0] for light in (None, even)
    )
    detector = sensor.detector
    gain = (pattern["gain"] / pattern["threshold"]).ravel()
    assert lit - dark == pytest.approx(1e-3 * gain / detector.sunlit_us, rel=1e-6)


def test_stray_light_slopes_across_full_frames_from_edge_to_edge() -> None:
    sensor = nominal("ccd-multi-aperture")
    pixels = replace(sensor.detector, columns=128, rows=96, errors=PixelErrors())
    mask = grid(3, 3, 0.3, Aperture("round", 0.1, 0.1))
    camera = replace(sensor.camera, mask=mask)
    sensor = replace(sensor, camera=camera, detector=pixels, spectrum=None)
    scene, pattern = lit_by(AHEAD), sensor.fixed_pattern("test")
    uneven = UnevenScene.of(scene, np.array([[0.004, -0.002]]))
    gain = sensor.detector.sunlit_e * pattern["gain"] / sensor.detector.gain_e_per_dn
    change = (sensor.expected(uneven, pattern) - sensor.expected(scene, pattern))[0] / gain
    x, y = (np.arange(128) - 63.5) / 64.0, (np.arange(96) - 47.5) / 48.0
    assert change == pytest.approx(0.004 * x[None, :] - 0.002 * y[:, None], abs=1e-9)
    near = LitPixels(sensor, uneven, pattern)
    whole, kept = sensor.expected(uneven, pattern)[0].ravel(), near.expected(uneven, pattern)[0]
    mine = near._pixels[0][near._pixels[0] >= 0]
    # light on them is kept in single precision
    assert kept[: len(mine)] == pytest.approx(whole[mine], rel=1e-7)
    rest = np.setdiff1d(np.arange(whole.size), mine)
    assert kept[-1] == pytest.approx(whole[rest].mean(), rel=1e-9)


def test_every_sensor_behind_openings_has_the_earth_among_its_conditions() -> None:
    seen = 0
    for name in datasets.names():
        preset = datasets.get(name)
        first = next(iter(preset.setups.values()))
        if not isinstance(first.sensor, SeesEarth):
            continue
        seen += 1
        if isinstance(preset, FlightPreset):
            without = {n for n, setup in preset.setups.items() if setup.earth is None}
            assert without <= {"no-albedo"}, name
        else:
            setup = preset.condition("albedo")
            assert setup.earth == Earth(), name
            assert (setup.sensor, setup.irradiance) == (first.sensor, first.irradiance), name
    assert seen == 35


def test_in_orbit_the_earth_shines_through_the_hole_where_it_is_ahead_and_lit() -> None:
    preset = datasets.get("ccd-orbit")
    assert isinstance(preset, FlightPreset)
    scene, leg = preset.scene("nominal", "test"), preset.flight.leg("test")
    assert scene.albedo is not None
    brightest = scene.albedo.reshape(len(scene), -1).max(axis=1)
    assert not brightest[leg.eclipse].any()
    # farther from nadir than Earth's limb and the window's corners reach: 66 and 70 deg
    assert not brightest[leg.nadir_body[:, 2] < math.cos(math.radians(136.0))].any()
    # all of Earth's radiance, 0.3 / pi, through 0.2 mm at a distance of 2 mm
    assert 1e-5 < brightest.max() < 0.3 / math.pi * (0.2 / 2.0) ** 2 * 1.04
