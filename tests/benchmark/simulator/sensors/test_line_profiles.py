"""Profiles in geometric shadow: dense ray count, closed forms, other exact areas, energy."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import incident, lit_by

from benchmark import datasets
from benchmark.simulator.kernels.areas import lit_boxes
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.masks.slits import SlitErrors, slit, slit_row
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.line_sensor import LineSensor

H_MM, PITCH_MM, HEIGHT_MM, COLUMNS = 2.5, 0.014, 0.2, 1024
NAMES = (
    "ccd-multi-slit",
    "ccd-n-slit",
    "ccd-periodic",
    "ccd-slit",
    "ccd-v-slit",
    "ccd-vernier",
    "pda-multi-slit",
    "pda-slit",
)


def sensor_with(mask: Mask, **changes: Any) -> LineSensor:
    nominal = datasets.get("ccd-slit").setups["nominal"].sensor
    assert isinstance(nominal, LineSensor)
    glass = changes.pop("glass", CoverGlass())
    sun = changes.pop("sun", nominal.camera.sun)
    camera = Camera(H_MM, mask, sun, glass)
    return replace(nominal, camera=camera, **{"errors": SlitErrors(), "spectrum": None, **changes})


def sun_rays(
    centre: np.ndarray, rings: int, spokes: int
) -> list[tuple[float, float, float, float]]:
    """Rays (direction, weight) of a limb-darkened disc 0.533 deg wide, equal areas on a polar grid.

    The weight is the flux on the detector plane before any glass, in units of the disc's.
    """
    helper = np.array([0.3, -0.5, 0.8])
    one = np.cross(centre, helper)
    one /= np.linalg.norm(one)
    two = np.cross(centre, one)
    reach = math.sin(math.radians(0.2665))
    rays = []
    for ring in range(rings):
        r = math.sqrt((ring + 0.5) / rings)
        weight = (1 - 0.6 * (1 - math.sqrt(1 - r * r))) / (1 - 0.6 / 3)
        for spoke in range(spokes):
            turn = 2 * math.pi * (spoke + (ring * 0.618) % 1) / spokes
            x, y = reach * r * math.cos(turn), reach * r * math.sin(turn)
            d = math.sqrt(1 - x * x - y * y) * centre + x * one + y * two
            rays.append((d[0], d[1], d[2], weight * d[2] / (rings * spokes)))
    return rays


def fresnel(cosine: float, index: float) -> float:
    """Share of unpolarised light through both faces of a plate, from the angles' sines."""
    if index == 1:
        return 1.0
    if cosine > 1 - 1e-9:
        return (1 - ((index - 1) / (index + 1)) ** 2) ** 2
    i = math.acos(cosine)
    t = math.asin(math.sin(i) / index)
    across = (math.sin(i - t) / math.sin(i + t)) ** 2
    along = (math.tan(i - t) / math.tan(i + t)) ** 2
    return ((1 - across) ** 2 + (1 - along) ** 2) / 2


def _passes(place, ray, plate, glass, slits):
    """Trace a ray back from places (u, v) of the detector: do they get it through a slit?

    The plate is the plane through (0, 0, height) spanned by (1, 0, 0) and
    (0, cos delta, sin delta), turned about its normal by theta; each slit opens its thickness.
    """
    u, v = place
    height, thickness, delta, theta = plate
    du, dv = ray[0] / ray[2], ray[1] / ray[2]
    # leaves the glass displaced: over it lies vacuum
    sine2 = ray[0] ** 2 + ray[1] ** 2
    inside = math.sqrt(glass[1] ** 2 - sine2)
    u0 = u - ray[0] / inside * glass[0]
    v0 = v - ray[1] / inside * glass[0]
    through = np.zeros(u.shape, dtype=bool)
    for half_width, half_length, position, slant in slits:
        inside_both = np.ones(u.shape, dtype=bool)
        for side in (-0.5, 0.5):
            lift = side * thickness
            # point of the ray at height z: (u0 - (z - t) du, v0 - (z - t) dv)
            # plane: v = q cos(delta) - lift sin(delta), z = height + q sin(delta) + lift cos(delta)
            base = height + lift * math.cos(delta) - glass[0]
            q = (v0 - base * dv + lift * math.sin(delta)) / (math.cos(delta) + math.sin(delta) * dv)
            p = u0 - (base + q * math.sin(delta)) * du
            x = math.cos(theta) * p + math.sin(theta) * q - position
            y = math.cos(theta) * q - math.sin(theta) * p
            across = math.cos(slant) * x + math.sin(slant) * y
            along = math.cos(slant) * y - math.sin(slant) * x
            inside_both &= (np.abs(across) <= half_width) & (np.abs(along) <= half_length)
        through |= inside_both
    return through


def _count(pixels, rays, layout, hardware):
    """Share of light that arrives on each pixel, by rays from a grid of places on it.

    The grid moves from ray to ray in a low-discrepancy sequence.
    """
    pitch, height, sub = layout
    profile = np.zeros(pixels.size)
    a, b = (axis.ravel() for axis in np.mgrid[:sub, :sub])
    for k, ray in enumerate(rays):
        u = (pixels[:, None] + (a + (k * 0.7548776662 + 0.5) % 1.0) / sub) * pitch
        v = ((b + (k * 0.5698402909 + 0.5) % 1.0) / sub - 0.5) * height
        profile += ray[3] * _passes((u, v), ray, *hardware).mean(axis=1)
    return profile


#: Slants, thickness, plate of glass, deflection and inclination, azimuth of the Sun.
RAY_CASES = {
    "thin": ((0.0,), 0.0, (0.0, 1.0), (0.0, 0.0), 0.0),
    "thick-glass": ((0.0,), 0.05, (0.5, 1.52), (0.0, 0.0), 130.0),
    "slanted": ((45.0,), 0.05, (0.5, 1.52), (0.0, 0.0), -70.0),
    "askew": ((0.0, -30.0), 0.02, (0.0, 1.0), (2.0, 3.0), 35.0),
}


@pytest.mark.parametrize("theta", [0.0, pytest.param(30.0, marks=pytest.mark.slow), 60.0])
@pytest.mark.parametrize(
    "case",
    [
        "thick-glass",
        "slanted",
        pytest.param("thin", marks=pytest.mark.slow),
        pytest.param("askew", marks=pytest.mark.slow),
    ],
)
def test_profiles_agree_with_a_dense_ray_count(theta: float, case: str) -> None:
    slants, thickness, glass, errors, azimuth = RAY_CASES[case]
    # far enough apart not to cross
    placed = list(zip((-3.0, 3.0), slants, strict=False))
    sensor = sensor_with(
        Mask(tuple(slit(0.25, 16.0, at, slant) for at, slant in placed), thickness),
        glass=CoverGlass((Plate(*glass),) if glass[0] else ()),
        errors=SlitErrors(*errors),
    )
    slits = np.array([(0.125, 8.0, at, math.radians(slant)) for at, slant in placed])
    sun = incident(theta, azimuth)
    lit = sensor.lit(lit_by(sun))[0]
    all_rays = np.array(
        [(x, y, z, w * fresnel(z, glass[1])) for x, y, z, w in sun_rays(sun[0], 45, 54)]
    )
    for number, axis in enumerate(sensor.axes):
        part = lit[number * COLUMNS : (number + 1) * COLUMNS]
        pixels = np.flatnonzero(np.convolve(part > 1e-9, np.ones(5), "same"))
        rays, turn = all_rays, math.radians(errors[0])
        if axis == "y":
            rays, turn = rays[:, [1, 0, 2, 3]], -turn
        plate = (H_MM, thickness, math.radians(errors[1]), turn)
        layout = (PITCH_MM, HEIGHT_MM, 4)
        counted = _count(pixels - COLUMNS / 2, rays, layout, (plate, glass, slits))
        shown = part[pixels]
        assert np.abs(shown - counted).max() < 0.005 * counted.max()
        for spot in np.split(np.arange(pixels.size), np.flatnonzero(np.diff(pixels) > 1) + 1):
            middle = [(pixels[spot] @ p[spot]) / p[spot].sum() for p in (shown, counted)]
            assert abs(middle[1] - middle[0]) < 2e-3
        assert shown.sum() == pytest.approx(counted.sum(), rel=1e-3)


def test_profile_at_noon_is_the_slit_convolved_with_the_disc() -> None:
    """Marginal of a limb-darkened disc along an axis, integrated: closed form."""
    u, reach = 0.6, H_MM * math.tan(math.radians(0.2665)) / PITCH_MM

    def marginal_integral(x: np.ndarray) -> np.ndarray:
        """Light left of x in units of the radius; radiance 1 - u + u sqrt(1 - r^2)."""
        x = np.clip(x, -1, 1)
        disc = (x * np.sqrt(1 - x**2) + np.arcsin(x) + math.pi / 2) * (1 - u)
        dome = u * math.pi / 2 * (x - x**3 / 3 + 2 / 3)
        return (disc + dome) / (math.pi * (1 - u / 3))

    sensor = sensor_with(slit_row((0.0037,), 0.25, 16.0))
    lit = sensor.lit(lit_by(np.array([[0.0, 0.0, 1.0]])))[0][:COLUMNS]
    nodes, shares = np.polynomial.legendre.leggauss(40)
    place = np.arange(COLUMNS)[:, None] - (COLUMNS - 1) / 2 + nodes / 2 - 0.0037 / PITCH_MM
    half = 0.125 / PITCH_MM
    light = marginal_integral((place + half) / reach) - marginal_integral((place - half) / reach)
    assert np.abs(lit - light @ shares / 2).max() < 2e-3
    assert lit.sum() == pytest.approx(2 * half, rel=1e-4)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    aperture=st.builds(
        slit, st.floats(0.02, 0.5), st.floats(0.05, 3.0), st.floats(-1, 1), st.floats(-60, 60)
    ),
    angles=st.tuples(st.floats(-20, 20), st.floats(-20, 20)),
    thickness=st.sampled_from([0.0, 0.04]),
)
def test_pixels_are_the_exact_areas_of_the_other_kernel(aperture, angles, thickness) -> None:
    """Ramps and polygons against half-plane areas; slits may end on the array or miss it."""
    mask = Mask((aperture,), thickness)
    nominal = sensor_with(mask, sun=SolarDisc(diameter_deg=0.0), axes=("x",), fill_factor=0.8)
    sensor = replace(nominal, detector=replace(nominal.detector, columns=256))
    sun = from_angles(np.array(angles[:1]), np.array(angles[1:]))
    lit = sensor.lit(lit_by(sun))
    low = (np.arange(256) - 128.0) * PITCH_MM
    half = HEIGHT_MM / 2
    boxes = np.column_stack(
        [low + 0.1 * PITCH_MM, low + 0.9 * PITCH_MM, np.full(256, -half), np.full(256, half)]
    )
    area, projected = np.empty((1, 256)), sensor.camera.project(sun)
    lit_boxes(area, boxes, mask.table(), projected.rims_mm, projected.light)
    assert lit == pytest.approx(area / (0.8 * PITCH_MM * HEIGHT_MM), abs=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_no_light_is_lost_anywhere_in_the_field(name: str) -> None:
    """A longer array behind longer slits collects no more; energy is the open width's.

    Of light that comes straight: a second image falls three heights away, beyond arrays' ends.
    """
    preset = datasets.get(name)
    half = preset.directions.half_fov_deg
    edge = np.array([-half, 0.0, half, -half, half, -half, half])
    sun = from_angles(edge, np.array([-half, 0.0, -half, half, half, 0.0, 0.0]))
    for condition, setup in preset.setups.items():
        sensor = replace(setup.sensor, fill_factor=1.0, spectrum=None, ghost=None)
        mask = sensor.camera.mask
        longer = Mask(
            tuple(replace(a, height_mm=2 * a.height_mm) for a in mask.apertures),
            mask.thickness_mm,
        )
        wide = replace(
            sensor,
            camera=replace(sensor.camera, mask=longer),
            detector=replace(sensor.detector, columns=2 * sensor.detector.columns),
        )
        found, whole = (
            s.lit(lit_by(sun)).reshape(len(sun), len(s.axes), -1).sum(axis=2)
            for s in (sensor, wide)
        )
        assert found == pytest.approx(whole, rel=1e-9), condition
        # diffracted light beside a slit's end is not known: no end comes near an array
        long = replace(sensor, camera=wide.camera, spectrum=SUNLIT_SILICON)
        short = replace(sensor, spectrum=SUNLIT_SILICON)
        assert np.array_equal(short.lit(lit_by(sun)), long.lit(lit_by(sun))), condition
    ideal = replace(
        wide,
        camera=replace(
            wide.camera,
            mask=Mask(longer.apertures),
            glass=CoverGlass(),
            assembly=Assembly(),
        ),
        errors=SlitErrors(),
    )
    points = ideal.camera.sun.directions(sun)[..., 2] @ ideal.camera.sun.quadrature()[1]
    open_px = (
        sum(a.width_mm / math.cos(math.radians(a.rotation_deg)) for a in mask.apertures)
        / sensor.detector.pitch_mm
    )
    caught = ideal.lit(lit_by(sun)).reshape(len(sun), len(ideal.axes), -1).sum(axis=2)
    assert caught == pytest.approx(np.repeat(points[:, None] * open_px, len(ideal.axes), 1))


def test_noise_is_shot_read_and_rounding_and_dark_doubles() -> None:
    setup = datasets.get("ccd-slit").setups["nominal"]
    sensor = setup.sensor
    assert isinstance(sensor, LineSensor)
    pattern = sensor.fixed_pattern("test")
    sun = np.repeat(from_angles(np.array([10.0]), np.array([-25.0])), 400, axis=0)
    scene = Scene(sun, np.ones(400), np.full(400, 0.002))
    seen = sensor.observe(scene, pattern, NoiseStreams.named("test", "line")).astype(float)
    mean = sensor.expected(scene.part(0, 1), pattern)
    spread = (seen - mean).var(axis=0) / sensor.variance(mean)[0]
    lit = mean[0] > mean[0].max() / 2
    for pixels in (lit, ~lit):
        assert spread[pixels].mean() == pytest.approx(
            1.0, abs=6 * math.sqrt(2 / 400 / pixels.sum())
        )
    dark = [
        replace(
            sensor,
            detector=replace(sensor.detector, dark=replace(sensor.detector.dark, temperature_c=t)),
        ).fixed_pattern("test")["dark_e"]
        for t in (25.0, 32.0)
    ]
    assert dark[1] == pytest.approx(2 * dark[0])
    assert dark[0].mean() == pytest.approx(50.0, rel=0.01)
