"""Patches of clouds: their mean, their place in the radiance, and that faces and openings agree."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmark import datasets
from benchmark.seeds import generator
from benchmark.simulator.light.clouds import Clouds, CloudyEarth
from benchmark.simulator.light.environment import Earth, uniform_direction
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.earthlight import EarthInView, Points, on_points
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.scene import Scene


def sphere(rows: int = 120) -> np.ndarray:
    """Cells of equal area: even steps of height and longitude."""
    z, turn = np.meshgrid(
        (np.arange(rows) + 0.5) / rows * 2.0 - 1.0,
        (np.arange(2 * rows) + 0.5) / rows * math.pi,
    )
    root = np.sqrt(1.0 - z**2)
    return np.stack([root * np.cos(turn), root * np.sin(turn), z], axis=-1).reshape(-1, 3)


def test_clouds_cover_what_they_are_said_to() -> None:
    """On another grid than the one that set the threshold: 4,000 points, each a 400 km square."""
    earth = CloudyEarth()
    cover = earth.clouds.over(sphere(), earth.radius_km)
    assert cover.min() == 0.0
    assert cover.max() == 1.0
    assert cover.mean() == pytest.approx(0.67, abs=0.003)
    assert np.mean((cover > 0) & (cover < 1)) < 0.3  # patches, not haze
    assert np.mean(earth.sent_back(sphere())) == pytest.approx(0.3, abs=0.001)


@pytest.mark.parametrize("clouds", [Clouds(), Clouds(softness=0.02, waves=7), Clouds(softness=4)])
def test_cover_is_the_sum_of_waves_cut_off_softly(clouds: Clouds) -> None:
    """Where the kernel's table of cosines tells that ground is clear or clouded, too."""
    ground, radius_km = sphere(), CloudyEarth().radius_km
    waves = clouds.table(radius_km)
    field = np.cos(ground @ waves[:, :3].T + waves[:, 3]).sum(axis=1) * math.sqrt(2 / len(waves))
    soft = (field - clouds.threshold(radius_km)) / clouds.softness + 0.5
    cover = clouds.over(ground, radius_km)
    np.testing.assert_allclose(cover, np.clip(soft, 0.0, 1.0), atol=1e-10)


def test_clouds_are_as_bright_as_the_mean_asks() -> None:
    earth = CloudyEarth(reflectance=0.3, clouds=Clouds(cover=0.5, clear=0.1))
    assert earth.cloudy == pytest.approx(0.5)
    with pytest.raises(ValueError, match=r"clouds that reflect 1.4"):
        CloudyEarth(reflectance=0.75, clouds=Clouds(cover=0.5, clear=0.1))
    with pytest.raises(ValueError, match=r"must be in \[clear, 1\]"):
        CloudyEarth(reflectance=0.1)


def test_kernel_and_faces_see_the_same_ground() -> None:
    """Through a small hole straight ahead light is the radiance of one spot: nadir's."""
    earth = CloudyEarth()
    stream = generator("test", "ground")
    nadir = np.array([uniform_direction(stream) for _ in range(200)])
    nadir = nadir[nadir[:, 2] > 0.95]
    sun = -nadir
    hole = Camera(1.0, Mask((Aperture("round", 1e-3, 1e-3),)), SolarDisc(diameter_deg=0.0))
    for one, above in zip(nadir, sun, strict=True):
        tangent = one[:2] / one[2]
        points = Points(tangent[None], (1.0, 1.0), 1, 1)
        light = on_points(hole, points, EarthInView(earth, one[None], above[None]), rays=1)
        area = math.pi * 5e-4**2 * one[2] ** 4
        expected = earth.sent_back(-one[None]) / math.pi * area
        # the table of sines moves the spot by 1e-5 rad, on ground that changes over a tenth
        assert light[0, 0, 0] == pytest.approx(float(np.ravel(expected)[0]), rel=2e-3)


def test_clouds_without_contrast_are_the_even_earth() -> None:
    even, same = Earth(), CloudyEarth(clouds=Clouds(clear=0.3))
    sensor = datasets.get("qpd-single-aperture").setups["nominal"].sensor
    sun = np.array([[0.3, -0.2, math.sqrt(0.87)]] * 5)
    nadir = even.draw_nadir(sun, generator("test", "even"))
    scene = Scene(sun, np.ones(5), np.zeros(5))
    through = [sensor.earth_through(earth, nadir, scene, {}) for earth in (even, same)]
    assert through[0] == pytest.approx(through[1], rel=1e-12)
    normals = np.eye(3)
    bare = [earth.response(sun, nadir, normals, "cosine") for earth in (even, same)]
    assert bare[0] == pytest.approx(bare[1], rel=1e-12)


@pytest.mark.slow
def test_conditions_with_and_without_clouds_differ_in_them_alone() -> None:
    preset = datasets.get("qpd-single-aperture")
    even, cloudy = preset.scene("albedo", "test"), preset.scene("albedo-clouds", "test")
    assert np.array_equal(even.sun, cloudy.sun)
    assert even.albedo is not None
    assert cloudy.albedo is not None
    lit = even.albedo.sum(axis=1) > 1e-4
    ratio = cloudy.albedo.sum(axis=1)[lit] / even.albedo.sum(axis=1)[lit]
    # clouds come twice to an Earth's disc: ground of half to 1.25 of the mean
    assert 0.5 - 1e-9 <= ratio.min() < 0.8
    assert 1.1 < ratio.max() <= 0.374 / 0.3 + 0.001
