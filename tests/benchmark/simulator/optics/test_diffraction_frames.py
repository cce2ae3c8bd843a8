"""Diffracted frames against the Kirchhoff integral, the shadow, and themselves."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from bare_pixels import bare
from closed_forms import slit_intensity
from shadows import shadows

from benchmark import datasets
from benchmark.metrics.bounds import cramer_rao
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor
from benchmark.simulator.sensors.frames import FrameSensor

NAME = "cmos-single-aperture-pinhole"
GREEN = Spectrum((550.0,), (1.0,))
GREEN_MM = 550e-6


def pinhole() -> DiffractiveFrameSensor:
    sensor = datasets.get(NAME).setups["nominal"].sensor
    assert isinstance(sensor, DiffractiveFrameSensor)
    camera = replace(sensor.camera, assembly=Assembly())
    return replace(sensor, camera=camera, detector=bare(sensor.detector))


@cache
def behind(number: float, shape: str = "round", per_half: int = 12) -> DiffractiveFrameSensor:
    """A sensor 1.2 mm below an aperture of this Fresnel number: so many pixels a half width.

    Its window is as wide as 5 1/3 half widths, whatever its pixels.
    """
    half = math.sqrt(number * GREEN_MM * 1.2)
    base = pinhole()
    mask = Mask((Aperture(shape, 2.0 * half, 2.0 * half),))
    detector = replace(base.detector, columns=2048, rows=2048, pitch_mm=half / per_half)
    window = 16 * per_half // 3, 16 * per_half // 3
    camera = Camera(1.2, mask, SolarDisc())
    return replace(base, camera=camera, detector=detector, window_px=window, widest_deg=60.0)


def scene_at(sensor: FrameSensor, alpha: list[float], beta: list[float]) -> Scene:
    sun = from_angles(np.array(alpha), np.array(beta))
    half = np.array(sensor.window_px) // 2
    origin = np.rint(sensor.spot_px(sun)).astype(np.int64) - half
    return Scene(sun, np.ones(len(sun)), np.zeros(len(sun)), origin)


def kirchhoff(sun, places, half_mm, height_mm, wavelength_mm, *, square=False, nodes=48):
    """Irradiance at places (P, 2) from the whole path lengths over the aperture; normal Sun 1.

    Behind a black screen: the mean of Rayleigh's integrals of the field and of its slope.
    """
    grid, shares = np.polynomial.legendre.leggauss(nodes)
    if square:
        qx, qy = (axis.ravel() for axis in np.meshgrid(grid, grid))
        weights = np.outer(shares, shares).ravel()
    else:
        radius = (grid[:, None] + 1.0) / 2.0
        turn = 2.0 * math.pi * (np.arange(2 * nodes) + 0.5) / (2 * nodes)
        qx, qy = (radius * np.cos(turn)).ravel(), (radius * np.sin(turn)).ravel()
        weights = np.repeat(shares / 2.0 * radius[:, 0] * math.pi / nodes, 2 * nodes)
    qx, qy, weights = half_mm * qx, half_mm * qy, half_mm**2 * weights
    path = np.sqrt((places[:, :1] - qx) ** 2 + (places[:, 1:] - qy) ** 2 + height_mm**2)
    phase = 2.0 * math.pi / wavelength_mm * (path + sun[0] * qx + sun[1] * qy)
    slant = (height_mm / path + sun[2]) / 2.0
    field = np.sum(weights * np.exp(1j * phase) * slant / path, axis=1) / wavelength_mm
    leaving = height_mm / np.sqrt(np.sum(places**2, axis=1) + height_mm**2)
    return np.abs(field) ** 2 * leaving


def places_of(sensor: FrameSensor, origin: np.ndarray, pixels: np.ndarray, sub: int) -> np.ndarray:
    """Millimetres of sub x sub Gauss points in each pixel (row, column), and their weights."""
    nodes, shares = np.polynomial.legendre.leggauss(sub)
    middle = np.asarray(sensor.detector.centre_px)
    pixel = pixels[:, ::-1] + origin - middle
    x = pixel[:, :1] + np.repeat(nodes / 2.0, sub)
    y = pixel[:, 1:] + np.tile(nodes / 2.0, sub)
    weights = np.outer(shares, shares).ravel() / 4.0
    return np.stack([x, y], axis=-1) * sensor.detector.pitch_mm, weights


@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (20.0, -30.0), (30.0, 30.0)])
def test_pinhole_frames_are_the_kirchhoff_integral(alpha: float, beta: float) -> None:
    """Every wavelength, a Sun of its own points, pixels integrated; path lengths not expanded."""
    sensor = pinhole()
    scene = scene_at(sensor, [alpha], [beta])
    assert scene.origin_px is not None
    rendered = sensor.lit(scene)[0]
    rng = np.random.default_rng(3)
    pixels = np.concatenate([[[32, 32], [30, 35]], rng.integers(8, 56, size=(14, 2))])
    places, weights = places_of(sensor, scene.origin_px[0], pixels, 3)
    sun = scene.sun[0]
    first = np.cross([0.0, 1.0, 0.0], sun)
    first /= np.linalg.norm(first)
    second = np.cross(sun, first)
    expected = np.zeros(len(pixels))
    nodes, shares = np.polynomial.legendre.leggauss(3)
    for node, share in zip(nodes, shares, strict=True):
        area = (node + 1.0) / 2.0
        radiance = share * (1.0 - 0.6 * (1.0 - math.sqrt(1.0 - area)))
        for turn in 2.0 * math.pi * np.arange(6) / 6:
            off = math.sin(math.radians(0.533 / 2)) * math.sqrt(area)
            point = sun + off * (math.cos(turn) * first + math.sin(turn) * second)
            point /= np.linalg.norm(point)
            for wavelength, weight in zip(
                sensor.spectrum.wavelengths_nm, sensor.spectrum.weights, strict=True
            ):
                light = kirchhoff(
                    point, places.reshape(-1, 2), 0.01, 7.0, wavelength * 1e-6, nodes=8
                )
                expected += radiance * weight / 6 * (light.reshape(len(pixels), -1) @ weights)
    total = sum(
        share * (1.0 - 0.6 * (1.0 - math.sqrt(1.0 - (node + 1.0) / 2.0)))
        for node, share in zip(nodes, shares, strict=True)
    )
    found = rendered[pixels[:, 0], pixels[:, 1]]
    assert np.abs(found - expected / total).max() < 1e-3 * rendered.max()


@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (0.0, 25.0), (-15.0, 20.0)])
def test_close_hole_is_the_kirchhoff_integral(alpha: float, beta: float) -> None:
    """Fresnel number 2, one colour of a point; the cubic phase counts to first order."""
    base = behind(2.0)
    camera = Camera(10.0, Mask((Aperture("round", 0.209761770, 0.209761770),)), SolarDisc(0.0))
    detector = replace(base.detector, pitch_mm=0.0065)
    sensor = replace(base, camera=camera, detector=detector, spectrum=GREEN, widest_deg=40.0)
    scene = scene_at(sensor, [alpha], [beta])
    assert scene.origin_px is not None
    rendered = sensor.lit(scene)[0]
    row, column = (axis.ravel() for axis in np.mgrid[10:54:4, 10:54:4])
    pixels = np.stack([row, column], axis=1)
    places, weights = places_of(sensor, scene.origin_px[0], pixels, 2)
    light = kirchhoff(scene.sun[0], places.reshape(-1, 2), 0.104880885, 10.0, GREEN_MM)
    expected = light.reshape(len(pixels), -1) @ weights
    worst = np.abs(rendered[row, column] - expected).max() / rendered.max()
    assert worst < (1e-3 if alpha == beta == 0.0 else 0.03)


@pytest.mark.slow
@pytest.mark.parametrize("beta", [0.0, 25.0])
@pytest.mark.parametrize(
    ("pitch_mm", "step"), [(0.02, 1), pytest.param(0.0065, 3, marks=pytest.mark.slow)]
)
def test_square_hole_is_the_kirchhoff_integral(pitch_mm: float, step: int, beta: float) -> None:
    """Sun above an axis, in a single colour, whose fringes tables blur by half a per cent."""
    base = behind(2.0)
    camera = Camera(10.0, Mask((Aperture("rectangle", 0.2, 0.2),)), SolarDisc(0.0))
    detector = replace(base.detector, pitch_mm=pitch_mm)
    sensor = replace(base, camera=camera, detector=detector, spectrum=GREEN, widest_deg=40.0)
    scene = scene_at(sensor, [0.0], [beta])
    assert scene.origin_px is not None
    rendered = sensor.lit(scene)[0]
    near = slice(32 - 7 * step, 32 + 7 * step, step)  # 0.14 mm about the middle
    row, column = (axis.ravel() for axis in np.mgrid[near, near])
    pixels = np.stack([row, column], axis=1)
    places, weights = places_of(sensor, scene.origin_px[0], pixels, 3)
    light = kirchhoff(scene.sun[0], places.reshape(-1, 2), 0.1, 10.0, GREEN_MM, square=True)
    expected = light.reshape(len(pixels), -1) @ weights
    worst = np.abs(rendered[row, column] - expected).max() / rendered.max()
    assert worst < (0.01 if beta == 0.0 else 0.03)


@pytest.mark.slow
def test_diffraction_fades_into_the_shadow_as_the_hole_grows() -> None:
    """What the edges spread is as wide as ``1 / sqrt(N)`` of the hole.

    Where a pixel is wider than the fringes it averages them, and less than that is left.
    """
    apart = []
    for number in (4.0, 40.0, 400.0):
        sensor = behind(number, "rectangle")
        scene = scene_at(sensor, [20.0], [-30.0])
        shadow = shadows(sensor).lit(scene)[0]
        bent = sensor.lit(scene)[0]
        apart.append(np.abs(bent - shadow).mean() / shadow.mean())
    assert apart[0] / apart[1] > 0.8 * math.sqrt(10.0)
    assert apart[1] / apart[2] > 0.8 * math.sqrt(10.0)


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "pixels"), [("round", 0.03), ("rectangle", 0.03)])
def test_near_pattern_lies_where_the_shadow_would(shape: str, pixels: float) -> None:
    """Of pixels of 3 um: what the cubic phase moves, 0.02 px, and less behind a square hole."""
    sensor = behind(2.0, shape)
    scene = scene_at(sensor, [0.0, 20.0, -35.0], [0.0, -30.0, 10.0])
    shadow = shadows(sensor).lit(scene)
    bent = sensor.lit(scene)
    y, x = np.mgrid[:64, :64]
    for one, other in zip(bent, shadow, strict=True):
        for axis in (x, y):
            apart = (axis * one).sum() / one.sum() - (axis * other).sum() / other.sum()
            assert abs(apart) < pixels


@pytest.mark.slow
def test_light_of_a_square_hole_in_the_window_is_that_of_two_slits() -> None:
    """Window of 16/6 hole widths; the Sun's blur at its edge is far below the tail's change."""
    sensor = behind(2.0, "rectangle", 3)
    bent = sensor.lit(scene_at(sensor, [0.0], [0.0]))[0]
    position = np.linspace(-16 / 6, 16 / 6, 4001)
    expected = 0.0
    for wavelength, weight in zip(
        sensor.spectrum.wavelengths_nm, sensor.spectrum.weights, strict=True
    ):
        along = slit_intensity(position, 2.0 * 550.0 / wavelength)
        expected += weight * (np.trapezoid(along, position) / 2.0) ** 2
    # the window's middle is half a pixel off the spot
    assert bent.sum() / 6.0**2 == pytest.approx(expected, rel=2e-3)


def test_light_of_the_pinhole_is_conserved() -> None:
    """In a window 30 dark rings wide: all light of the hole but Airy's tail, 2 / (pi v)."""
    sensor = replace(pinhole(), window_px=(400, 400))
    detector = replace(sensor.detector, columns=1200, rows=1200)
    sensor = replace(sensor, detector=detector, spectrum=GREEN)
    scene = scene_at(sensor, [0.0, 15.0], [0.0, -20.0])
    frames = sensor.lit(scene)
    entered = math.pi * 0.01**2 * scene.sun[:, 2] / detector.pitch_mm**2
    missing = 2.0 / (math.pi * 2.0 * math.pi / GREEN_MM * 0.01 * (200 * 0.024 / 7.0))
    assert frames.sum(axis=(1, 2)) / entered == pytest.approx(1.0 - missing, abs=missing)


def test_noiseless_pinhole_frames_give_the_direction_back() -> None:
    """Gauss-Newton on the sensor's own expected frames from a tenth of a degree off."""
    preset = datasets.get(NAME)
    setup, pattern = preset.setups["nominal"], preset.fixed_pattern("nominal")
    alpha, beta = np.array([0.3, 21.0, -29.0]), np.array([-0.2, -14.0, 28.0])
    scene = scene_at(setup.sensor, list(alpha), list(beta))
    seen = setup.sensor.expected(scene, pattern).reshape(3, -1)
    guess = np.column_stack([alpha + 0.1, beta - 0.1])

    def model(angles):
        moved = scene.seen_from(from_angles(angles[:, 0], angles[:, 1]))
        return setup.sensor.expected(moved, pattern).reshape(3, -1)

    for _ in range(6):
        here = model(guess)
        slopes = [(model(guess + step) - model(guess - step)) / 0.01 for step in 0.005 * np.eye(2)]
        for n in range(3):
            jacobian = np.stack([slope[n] for slope in slopes], axis=1)
            guess[n] += np.linalg.lstsq(jacobian, seen[n] - here[n], rcond=None)[0]
    assert np.abs(guess - np.column_stack([alpha, beta])).max() < 1e-6


def test_bound_of_the_pinhole_falls_with_the_square_root_of_the_photons() -> None:
    setup = datasets.get(NAME).setups["nominal"]
    scene = scene_at(setup.sensor, [10.0, 25.0], [-20.0, 5.0])
    found = []
    for electrons in (1e8, 4e8):
        detector = replace(
            setup.sensor.detector,
            sunlit_e=electrons,
            full_well_e=1e9,
            gain_e_per_dn=1.0,
            read_noise_e=0.0,
            bits=30,
        )
        sensor = replace(setup.sensor, detector=detector)
        bound = cramer_rao(sensor, scene, sensor.fixed_pattern("test"), setup.irradiance)
        found.append(bound.angle_deg)
    assert found[0] / found[1] == pytest.approx(2.0, rel=0.01)
