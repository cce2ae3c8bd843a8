"""CCD behind many holes, CMOS behind an L, CMOS and PDA behind an N: inverted and bounded."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from shadows import shadows

from benchmark import datasets
from benchmark.datasets import Preset
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.masks.slits import SlitErrors
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.scene import Scene

NAMES = ("ccd-multi-aperture", "cmos-l-slit", "cmos-n-slit", "pda-n-slit")
ANGLES = [(0.0, 0.0), (0.31, -0.17), (-21.0, 33.0), (49.0, -47.0), (-50.0, -50.0)]


def one_scene(sun: np.ndarray, origin: np.ndarray | None = None) -> Scene:
    return Scene(sun, np.ones(len(sun)), np.zeros(len(sun)), origin)


def perfect(name: str):
    """The preset's nominal sensor with a point Sun and nothing built wrong; glass stays.

    They cast shadows, which give a direction exactly.
    """
    sensor = datasets.get(name).setups["nominal"].sensor
    camera = replace(sensor.camera, sun=SolarDisc(0.0), assembly=Assembly())
    if name.endswith("n-slit"):
        # no gaps between pixels: where an edge lies within one would be anyone's guess
        return replace(sensor, camera=camera, errors=SlitErrors(), fill_factor=1.0, spectrum=None)
    if name == "ccd-multi-aperture":
        return replace(sensor, camera=camera, errors=MaskErrors(), spectrum=None)
    return shadows(sensor, camera=camera)


def angles(x_mm: float, y_mm: float, sensor) -> tuple[float, float]:
    """alpha, beta in degrees of the displacement (x, y); through glass by Snell's law."""
    height, reach = sensor.camera.focal_length_mm, math.hypot(x_mm, y_mm)
    plates = sensor.camera.glass.plates
    if reach < 1e-12:
        return 0.0, 0.0

    def excess(theta: float) -> float:
        inside = [p.thickness_mm * math.tan(math.asin(math.sin(theta) / p.index)) for p in plates]
        gap = height - sum(p.thickness_mm for p in plates)
        return gap * math.tan(theta) + sum(inside) - reach

    tangent = math.tan(brentq(excess, 0.0, math.radians(89.0), xtol=1e-15, rtol=1e-14)) / reach
    return math.degrees(math.atan(tangent * y_mm)), math.degrees(math.atan(tangent * x_mm))


def middle(profile: np.ndarray, width_px: float) -> float:
    """Middle of a symmetric, flat-topped spot from the light before a pixel border on its top.

    Light before the border, less half of all of it, is the top's height times the border's
    distance from the middle; height is all the light over the spot's mean width.
    """
    border = round(float(profile @ np.arange(len(profile)) / profile.sum()) + 0.5)
    height = profile.sum() / width_px
    return border - 0.5 - (profile[:border].sum() - profile.sum() / 2.0) / height


def displacements(sensor, sun: np.ndarray, middle_of) -> np.ndarray:
    """(324, 2) mm: every hole's spot less the hole, by the design."""
    data = datasets.get("ccd-multi-aperture")
    pattern = sensor.fixed_pattern("test")
    frame = sensor.lit(one_scene(sun), pattern)[0]
    pitch, centre = data.geometry.pixel_pitch_mm, np.array(data.geometry.centre_px)
    found = []
    boxes = sensor.boxes(one_scene(sun), pattern)[0]
    for (x, y, width), (left, right, top, bottom) in zip(
        data.geometry.apertures, boxes, strict=True
    ):
        part = frame[top:bottom, left:right]
        spot = [
            middle_of(part.sum(axis=axis), width / pitch) + first
            for axis, first in ((0, left), (1, top))
        ]
        found.append((np.array(spot) - centre) * pitch - [x, y])
    return np.array(found)


@pytest.mark.parametrize(("alpha", "beta"), ANGLES)
def test_every_square_hole_gives_the_direction_exactly(alpha: float, beta: float) -> None:
    sensor = perfect("ccd-multi-aperture")
    square = tuple(replace(a, shape="rectangle") for a in sensor.camera.mask.apertures)
    mask = replace(sensor.camera.mask, apertures=square)
    sensor = replace(sensor, camera=replace(sensor.camera, mask=mask))
    sun = from_angles(np.array([alpha]), np.array([beta]))
    for x, y in displacements(sensor, sun, middle):
        assert angles(x, y, sensor) == pytest.approx((alpha, beta), abs=1e-6)


@pytest.mark.parametrize(("alpha", "beta"), ANGLES)
def test_the_slits_of_the_l_give_the_direction_exactly(alpha: float, beta: float) -> None:
    data = datasets.get("cmos-l-slit")
    sensor = perfect("cmos-l-slit")
    # behind a foil with thickness spots are narrower than the slits, but as symmetric
    thin = replace(sensor.camera, mask=replace(sensor.camera.mask, thickness_mm=0.0))
    sensor = replace(sensor, camera=thin)
    sun = from_angles(np.array([alpha]), np.array([beta]))
    origin = sensor.origins(sun, np.random.default_rng(3))
    frame = sensor.lit(one_scene(sun, origin))[0]
    [(line, _, width)] = data.geometry.slits
    pitch, centre = data.geometry.pixel_pitch_mm, np.array(data.geometry.centre_px)
    # each line is read where the other one is not: in the window's last rows and columns lit
    found = []
    for image, first, half in (
        (frame, origin[0, 0], centre[0]),
        (frame.T, origin[0, 1], centre[1]),
    ):
        lit = np.flatnonzero(image.sum(axis=1) > 0)
        own = image[lit[-20] : lit[-5]].sum(axis=0)
        found.append((middle(own, width / pitch) + first - half) * pitch - line)
    assert angles(*found, sensor) == pytest.approx((alpha, beta), abs=1e-6)


@pytest.mark.parametrize(
    ("name", "alpha", "beta"),
    [(name, *pair) for name in ("cmos-n-slit", "pda-n-slit") for pair in ANGLES]
    + [("cmos-n-slit", 64.0, -64.0)],
)
def test_the_three_spots_of_the_n_give_the_direction_exactly(
    name: str, alpha: float, beta: float
) -> None:
    data, sensor = datasets.get(name), perfect(name)
    thin = replace(sensor.camera, mask=replace(sensor.camera.mask, thickness_mm=0.0))
    sensor = replace(sensor, camera=thin)
    profile = sensor.lit(one_scene(from_angles(np.array([alpha]), np.array([beta]))))[0]
    lit = np.flatnonzero(profile > 0)
    spots = np.split(lit, np.flatnonzero(np.diff(lit) > 1) + 1)
    assert len(spots) == 3
    moved = []
    for spot, (position, slant, width) in zip(spots, data.geometry.slits, strict=True):
        # a slanted slit is as wide as it is, or as the pixels are high: its top is level in between
        across = width / math.cos(math.radians(slant))
        across = max(across, sensor.pixel_height_mm * abs(math.tan(math.radians(slant))))
        across /= data.geometry.pixel_pitch_mm
        place = middle(profile[spot], across) + spot[0] - (data.geometry.line_pixels - 1) / 2.0
        moved.append(place * data.geometry.pixel_pitch_mm - position)
    slant = math.tan(math.radians(data.geometry.slits[0][1]))
    assert data.geometry.line_axes == ("y",)
    assert moved[0] == pytest.approx(moved[2], abs=1e-9)
    y = moved[1]  # model:nslit: the slit square to the array moves with one angle only
    x = (moved[0] - y) / slant
    assert angles(x, y, sensor) == pytest.approx((alpha, beta), abs=1e-6)


def few(name: str, steps: int = 3) -> Preset:
    data = datasets.get(name)
    return replace(data, directions=replace(data.directions, steps=steps, test_samples=7))


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_all_light_falls_on_the_pixels_read_out_and_saturates_none(name: str) -> None:
    """Also in the field's corners, in every condition: windows cut a skirt of light at most."""
    data = few(name)
    for condition, setup in data.setups.items():
        scene = data.scene(condition, "calibration")
        pattern = data.fixed_pattern(condition)
        still = replace(scene, stray=np.zeros(len(scene)))
        if name == "ccd-multi-aperture":
            light = setup.sensor.lit(still, pattern)
        else:
            light = setup.sensor.lit(still)
        rim = [light[:, 0], light[:, -1]]
        if light.ndim == 3:
            rim += [light[..., 0], light[..., -1]]
        # light is bent: its skirts reach the rim
        assert max(side.max() for side in rim) < 0.03 * light.max(), condition
        frames = data.generate(condition, "calibration").observations
        full = frames == 2**setup.sensor.detector.bits - 1
        # one pixel in a hundred is hot at the end of life
        assert np.mean(full) < (0.02 if condition == "aged" else 1e-9), condition
        assert np.mean(frames == 0) < 1e-3, condition


@pytest.mark.slow
def test_both_slits_of_the_l_weigh_alike() -> None:
    bound = few("cmos-l-slit").bound("nominal", "calibration")
    assert bound.alpha_deg[4] == pytest.approx(bound.beta_deg[4], rel=0.1)


@pytest.mark.parametrize("name", ["cmos-n-slit", "pda-n-slit"])
def test_the_spots_of_the_n_stay_in_order(name: str) -> None:
    """Three separate stretches of light in the field's corners, however the sensor is built."""
    data = few(name)
    for condition, setup in data.setups.items():
        scene = data.scene(condition, "calibration")
        light = setup.sensor.lit(scene)
        for lit in light > 0.2 * light.max(axis=1, keepdims=True):
            assert np.sum(lit[1:] & ~lit[:-1]) == 3, condition
