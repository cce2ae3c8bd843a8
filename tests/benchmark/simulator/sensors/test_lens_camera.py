"""Lens cameras: projection and light against OpenCV, closed forms and a dense reference."""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import ndtr

from benchmark import datasets
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.flare import Aureole, Flare, Ghost, Streak
from benchmark.simulator.optics.lens import Lens
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.lens_camera import LensCamera

NAMES = ("cmos-lens", "ccd-lens")


def camera_of(name: str, condition: str = "nominal") -> LensCamera:
    camera = datasets.get(name).setups[condition].sensor.camera
    assert isinstance(camera, LensCamera)
    return camera


def field(name: str, count: int = 200) -> np.ndarray:
    half = datasets.get(name).geometry.half_fov_deg
    angles = half * (2 * np.random.default_rng(3).random((count, 2)) - 1)
    return from_angles(angles[:, 0], angles[:, 1])


def apart_deg(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.degrees(np.linalg.norm(np.cross(one, other), axis=1))


@pytest.mark.parametrize("name", NAMES)
def test_without_distortion_the_image_is_where_a_pinhole_puts_it(name: str) -> None:
    sun = field(name)
    lens = camera_of(name).lens
    straight = Lens(lens.focal_length_mm, lens.pupil_mm)
    hole = Camera(lens.focal_length_mm, Mask((Aperture("round", 0.1, 0.1),)))
    assert straight.image_mm(sun) == pytest.approx(hole.spot_mm(sun), abs=1e-15)


@pytest.mark.parametrize("name", NAMES)
def test_distortion_is_brown_and_conradys_as_opencv_has_it(name: str) -> None:
    camera = camera_of(name)
    ideal = replace(camera, assembly=Assembly())
    sun = field(name)
    focal = camera.lens.focal_length_mm / camera.detector.pitch_mm
    x, y = camera.detector.centre_px
    matrix = np.array([[focal, 0, x], [0, focal, y], [0, 0, 1]])
    there, _ = cv2.projectPoints(
        sun, np.zeros(3), np.zeros(3), matrix, np.array([camera.lens.k1, camera.lens.k2, 0, 0])
    )
    assert ideal.image_px(sun) == pytest.approx(there[:, 0], abs=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_the_projection_is_inverted_exactly_with_distortion_and_misalignment(name: str) -> None:
    for condition in ("nominal", "misaligned"):
        camera = camera_of(name, condition)
        sun = field(name)
        assert apart_deg(camera.sun_of(camera.image_px(sun)), sun).max() < 1e-10


@settings(deadline=None, derandomize=True, max_examples=60)
@given(st.floats(-0.3, 0.3), st.floats(0.0, 0.1), st.floats(-60, 60), st.floats(-60, 60))
def test_a_direction_comes_back_or_is_said_to_be_folded(
    k1: float, k2: float, alpha: float, beta: float
) -> None:
    lens = Lens(2.0, 1.0, k1, k2)
    sun = from_angles(np.array([alpha]), np.array([beta]))
    square = np.sum((sun[:, :2] / sun[:, 2:]) ** 2)
    reach = np.linspace(0, 1, 500) * square
    back = lens.directions(lens.image_mm(sun))
    if (1 + 3 * k1 * reach + 5 * k2 * reach**2 > 0.05).all():
        assert apart_deg(back, sun)[0] < 1e-6
    elif not np.isnan(back).any():  # the nearer of several directions with this image
        assert lens.image_mm(back) == pytest.approx(lens.image_mm(sun), abs=1e-9)


def test_no_direction_is_imaged_beyond_the_fold() -> None:
    lens = Lens(1.0, 1.0, -0.2)  # r - 0.2 r^3 has its maximum 0.8607 at r = 1.291
    far = lens.directions(np.array([[0.86, 0.0], [0.87, 0.0]]))
    assert np.isnan(far).any(axis=1).tolist() == [False, True]


@pytest.mark.parametrize("name", NAMES)
def test_the_whole_field_falls_on_the_detector(name: str) -> None:
    preset = datasets.get(name)
    for condition in preset.conditions:
        camera = camera_of(name, condition)
        half = preset.geometry.half_fov_deg
        corners = from_angles(np.array([1, 1, -1, -1]) * half, np.array([1, -1, 1, -1]) * half)
        image = camera.image_px(corners)
        assert (image > 4).all()
        assert (image < camera.detector.columns - 5).all()


def clean(name: str) -> LensCamera:
    return replace(camera_of(name), flare=Flare(), assembly=Assembly())


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (7.3, -16.1), (-20.0, 20.0)])
def test_the_image_of_the_disc_agrees_with_a_dense_reference(
    name: str, alpha: float, beta: float
) -> None:
    """40,000 points of the limb-darkened disc, each projected by OpenCV and blurred by SciPy."""
    camera = clean(name)
    sun = from_angles(np.array([alpha]), np.array([beta]))
    grid = (np.arange(226) + 0.5) / 113 - 1
    x, y = (c.ravel() for c in np.meshgrid(grid, grid))
    rho2 = x**2 + y**2
    x, y, rho2 = x[rho2 < 1], y[rho2 < 1], rho2[rho2 < 1]
    weight = 1 - 0.6 * (1 - np.sqrt(1 - rho2))
    weight /= weight.sum()
    right = np.cross([0.0, 1.0, 0.0], sun[0])
    right /= np.linalg.norm(right)
    up = np.cross(sun[0], right)
    size = math.sin(math.radians(0.533 / 2))
    points = sun + size * (x[:, None] * right + y[:, None] * up)
    points -= sun * (1 - np.sqrt(1 - size**2 * rho2))[:, None]
    focal = camera.lens.focal_length_mm / camera.detector.pitch_mm
    matrix = np.array([[focal, 0, 0], [0, focal, 0], [0, 0, 1]]) + np.array(
        [[0, 0, camera.detector.centre_px[0]], [0, 0, camera.detector.centre_px[1]], [0, 0, 0]]
    )
    place, _ = cv2.projectPoints(
        points, np.zeros(3), np.zeros(3), matrix, np.array([camera.lens.k1, camera.lens.k2, 0, 0])
    )
    place = place[:, 0]
    sigma = camera.blur_mm / camera.detector.pitch_mm
    first = np.floor(place.min(axis=0) - 6 * sigma).astype(int)
    last = np.ceil(place.max(axis=0) + 6 * sigma).astype(int)
    across, along = (np.arange(first[a], last[a] + 2) - 0.5 for a in (0, 1))
    columns = np.diff(ndtr((across - place[:, :1]) / sigma), axis=1)
    rows = np.diff(ndtr((along - place[:, 1:]) / sigma), axis=1)
    reference = np.einsum("k,ki,kj->ij", weight, rows, columns)
    shares = camera.shares(sun)[0]
    window = shares[first[1] : last[1] + 1, first[0] : last[0] + 1]
    assert np.abs(window - reference).max() < 5e-3 * reference.max()
    assert shares.sum() == pytest.approx(1.0, abs=1e-12)
    index = np.indices(window.shape)
    found = [(index[a] * window).sum() / window.sum() for a in (1, 0)]
    true = [(index[a] * reference).sum() / reference.sum() for a in (1, 0)]
    assert found == pytest.approx(true, abs=2e-4)
    assert np.array(found) + first == pytest.approx(camera.image_px(sun)[0], abs=2e-3)


def aureole_share(x: np.ndarray, y: np.ndarray, a: float) -> np.ndarray:
    """Primitive of the aureole's profile: a solid angle over 2 pi."""
    return np.arctan(x * y / (a * np.sqrt(a**2 + x**2 + y**2))) / (2 * math.pi)


def test_an_aureole_has_the_light_of_its_closed_form_in_every_pixel() -> None:
    shares = np.zeros((1, 200, 180))
    Flare(Aureole(0.3, 0.012)).add(shares, np.array([[70.3, 120.8]]), np.zeros(2), 0.003)
    x, y = np.arange(181) - 0.5 - 70.3, np.arange(201) - 0.5 - 120.8
    primitive = aureole_share(x[None, :], y[:, None], 4.0)
    exact = 0.3 * np.diff(np.diff(primitive, axis=0), axis=1)
    assert shares[0] == pytest.approx(exact, rel=2e-3)
    assert shares.sum() == pytest.approx(exact.sum(), rel=1e-4)


def test_a_streak_has_the_light_of_two_lorentz_profiles() -> None:
    shares = np.zeros((1, 120, 160))
    streak = Streak(0.2, 90.0, 0.3, 0.02)
    Flare(streaks=(streak,)).add(shares, np.array([[80.2, 51.7]]), np.zeros(2), 0.01)
    along = np.diff(np.arctan((np.arange(121) - 0.5 - 51.7) / 30.0)) / math.pi
    across = np.diff(np.arctan((np.arange(161) - 0.5 - 80.2) / 2.0)) / math.pi
    assert shares[0] == pytest.approx(0.2 * along[:, None] * across[None, :], rel=5e-3)


def test_ghosts_lie_opposite_the_axis_with_their_share_of_the_light() -> None:
    shares = np.zeros((1, 250, 250))
    axis, image = np.array([124.5, 124.5]), np.array([[70.0, 140.0]])
    Flare(ghosts=(Ghost(0.05, -0.8, 0.06),)).add(shares, image, axis, 0.003)
    assert shares.sum() == pytest.approx(0.05, rel=2e-3)
    rows, columns = np.indices(shares[0].shape)
    centre = [(c * shares[0]).sum() / shares.sum() for c in (columns, rows)]
    assert centre == pytest.approx(axis - 0.8 * (image[0] - axis), abs=0.02)
    assert shares.max() == pytest.approx(0.05 / (math.pi * 20**2), rel=1e-9)


def test_light_is_neither_lost_nor_made() -> None:
    flare = Flare(Aureole(0.1, 0.01), 0.2, (Ghost(0.05, -0.5, 0.05),))
    camera = replace(clean("cmos-lens"), flare=flare)
    shares = camera.shares(from_angles(np.array([8.0]), np.array([-5.0])))
    assert flare.image_share == pytest.approx(0.65)
    # what is missing is the aureole beyond the detector: at most a / r of it, r = 100 px
    assert 1 - 0.1 * (0.01 / 0.3) - 1e-4 < shares.sum() < 1
    with pytest.raises(ValueError, match=r"shares.*\[0.*1\)"):
        Flare(Aureole(0.6, 0.01), veil=0.4)


@pytest.mark.parametrize("name", NAMES)
def test_the_lens_gathers_the_light_of_its_pupil(name: str) -> None:
    camera = clean(name)
    sun = from_angles(np.array([0.0, 21.0]), np.array([0.0, 0.0]))
    pattern = camera.fixed_pattern("unit")
    pattern = {**pattern, "gain": np.ones_like(pattern["gain"])}
    scene = Scene(sun, np.array([1.0, 1.1]), np.zeros(2))
    electrons = camera.photo_electrons(scene, pattern).sum(axis=(1, 2))
    area = math.pi / 4 * camera.lens.pupil_mm**2
    bare = camera.detector.sunlit_e / camera.detector.pitch_mm**2  # electrons a square millimetre
    expected = bare * area * np.array([1.0, 1.1 * math.cos(math.radians(21.0))])
    assert electrons == pytest.approx(expected, rel=1e-9)
