"""Diffracted profiles: the propagator of its own, closed forms, the limit of short waves."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import slit_propagator as propagator
from scipy.special import fresnel

from benchmark import datasets
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.masks.slits import SlitErrors, slit, slit_row
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON, Spectrum
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.line_sensor import LineAxis, LineSensor

POINT = SolarDisc(diameter_deg=0.0)
NAMES = (
    "ccd-multi-slit",
    "ccd-n-slit",
    "ccd-periodic",
    "ccd-slit",
    "ccd-v-slit",
    "ccd-vernier",
    "cmos-n-slit",
    "pda-multi-slit",
    "pda-n-slit",
    "pda-slit",
)


def aligned(name: str, **changes: Any) -> LineSensor:
    """The dataset's design, one array, without errors of assembly."""
    sensor = datasets.get(name).setups["nominal"].sensor
    assert isinstance(sensor, LineSensor)
    camera = replace(sensor.camera, assembly=Assembly(), **changes.pop("camera", {}))
    return replace(sensor, camera=camera, errors=SlitErrors(), axes=("x",), **changes)


def lit(sensor: LineSensor, *angles: tuple[float, float]) -> np.ndarray:
    sun = from_angles(*np.array(angles, dtype=float).T)
    return sensor.lit(Scene(sun, np.ones(len(sun)), np.zeros(len(sun))))


def line_of(sensor: LineSensor) -> propagator.Line:
    camera, detector = sensor.camera, sensor.detector
    return propagator.Line(
        slits=tuple((a.width_mm, a.x_mm, a.rotation_deg) for a in camera.mask.apertures),
        height=camera.focal_length_mm,
        thickness=camera.mask.thickness_mm,
        glass=tuple((plate.thickness_mm, plate.index) for plate in camera.glass.plates),
        pitch=detector.pitch_mm,
        columns=detector.columns,
        pixel_height=sensor.pixel_height_mm,
        fill=sensor.fill_factor,
    )


def assert_alike(found: np.ndarray, true: np.ndarray, share: float) -> None:
    """Within a share of the peak everywhere, centroids of the spots within 0.01 px."""
    assert np.abs(found - true).max() < share * true.max()
    bright = np.flatnonzero(true > 0.1 * true.max())
    for spot in np.split(bright, np.flatnonzero(np.diff(bright) > 4) + 1):
        middles = [(spot @ p[spot]) / p[spot].sum() for p in (found, true)]
        assert abs(middles[0] - middles[1]) < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("angles", [(0.0, 0.0), (0.0, 8.0), (60.0, 60.0)])
@pytest.mark.parametrize(
    ("name", "foil_mm"),
    [("ccd-slit", 0.0), ("ccd-slit", 0.01), ("cmos-n-slit", 0.0), ("pda-multi-slit", 0.05)],
)
def test_light_of_a_point_is_the_angular_spectrums(
    name: str, foil_mm: float, angles: tuple[float, float]
) -> None:
    """No disc smooths what is wrong: fringes, glass, slant, two rims; the same six wavelengths."""
    if name == "pda-multi-slit":
        angles = (min(angles[0], 51.5), min(angles[1], 51.5))
    mask = aligned(name).camera.mask
    sensor = aligned(name, camera={"sun": POINT, "mask": Mask(mask.apertures[:1], foil_mm)})
    sun = from_angles(*np.array([angles]).T)
    nm, weights = np.array(SUNLIT_SILICON.wavelengths_nm), np.array(SUNLIT_SILICON.weights)
    true = propagator.profile(line_of(sensor), sun[0], nm, weights, points=(sun, np.ones(1)))
    assert_alike(lit(sensor, angles)[0], true, 0.006)


CASES = (
    ("ccd-slit", (0.0, 0.0)),
    ("ccd-slit", (0.0, 60.0)),
    ("ccd-slit", (60.0, 60.0)),
    ("ccd-n-slit", (0.0, 0.0)),
    ("ccd-n-slit", (60.0, 0.0)),
    ("ccd-n-slit", (60.0, 60.0)),
    ("ccd-v-slit", (30.0, -60.0)),
    ("ccd-multi-slit", (0.0, 0.0)),
    ("ccd-multi-slit", (60.0, 60.0)),
    ("ccd-vernier", (0.0, 0.0)),
    ("ccd-vernier", (0.0, 64.0)),
    ("cmos-n-slit", (0.0, 0.0)),
    ("cmos-n-slit", (0.0, 64.0)),
    ("pda-slit", (0.0, 60.0)),
    ("pda-multi-slit", (0.0, 0.0)),
    ("pda-multi-slit", (0.0, 51.5)),
)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "angles"), CASES)
def test_sunlit_profiles_are_the_angular_spectrums(name: str, angles: tuple[float, float]) -> None:
    """Twelve wavelengths of a black body and 216 points of the Sun against six and chords."""
    sensor = aligned(name)
    sun = from_angles(*np.array([angles]).T)
    true = propagator.profile(line_of(sensor), sun[0], *propagator.sunlight(12))
    assert_alike(lit(sensor, angles)[0], true, 0.01 if angles == (0.0, 0.0) else 0.02)


@pytest.mark.parametrize("name", NAMES)
def test_six_wavelengths_do_for_sunlight(name: str) -> None:
    """Within 0.2 % of the peak of 48 bands of a black body."""
    nm, weights = propagator.sunlight(48)
    fine = Spectrum(tuple(nm.tolist()), tuple(weights.tolist()))
    edge = datasets.get(name).geometry.half_fov_deg
    assert edge is not None
    angles = ((0.0, 0.0), (0.3 * edge, 0.6 * edge), (0.0, edge), (edge, edge))
    found, true = (lit(aligned(name, spectrum=s), *angles) for s in (SUNLIT_SILICON, fine))
    assert (np.abs(found - true).max(axis=1) < 0.002 * true.max(axis=1)).all()


@pytest.mark.slow
def test_one_wavelength_of_a_point_is_fresnels_pattern() -> None:
    """Straight from above: ``|F(u+) - F(u-)|^2 / 2``, pixels by Gauss."""
    wave, height, half = 600e-6, 3.0, 0.06
    sensor = aligned(
        "ccd-slit",
        camera={"sun": POINT, "mask": slit_row((0.003,), 2 * half, 9.0), "focal_length_mm": height},
        spectrum=Spectrum((600.0,), (1.0,)),
        fill_factor=0.8,
    )
    nodes, shares = np.polynomial.legendre.leggauss(20)
    place = (np.arange(1024)[:, None] - 511.5 + 0.4 * nodes) * 0.014 - 0.003
    root = math.sqrt(2 / (wave * height))
    (s1, c1), (s2, c2) = fresnel(root * (place + half)), fresnel(root * (place - half))
    true = ((c1 - c2) ** 2 + (s1 - s2) ** 2) / 2 @ shares / 2
    found = lit(sensor, (0.0, 0.0))[0]
    near = np.abs(np.arange(1024) - 511.5) < 15
    assert np.abs(found - true)[near].max() < 4e-3  # four values a period, and no disc
    # beyond the grid fringes are left out: no more than their own height
    far = np.abs(place).min(axis=1) > half
    skirt = 2 * wave * height / (math.pi**2 * (np.abs(place).min(axis=1) - half) ** 2)
    assert (np.abs(found - true)[far] <= skirt[far]).all()


@pytest.mark.parametrize("axis", ["x", pytest.param("y", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "case",
    [
        {"thickness": 0.05},
        {"glass": CoverGlass((Plate(0.5, 1.52),)), "slant": 45.0},
        {"errors": SlitErrors(2.0, 3.0), "slant": -30.0, "thickness": 0.02},
        {"errors": SlitErrors(-1.0, -2.0), "fill_factor": 0.7},
        {"assembly": Assembly(1.0, -0.7, 0.5, 0.03, 0.05, -0.04), "slant": 10.0},
    ],
)
def test_short_waves_cast_geometric_shadows(case: dict[str, Any], axis: LineAxis) -> None:
    """At 5 nm an edge is 3 um wide: rims, glass, slant and plate are where the rays put them."""
    case = dict(case)
    mask = Mask((slit(0.25, 16.0, 0.4, case.pop("slant", 0.0)),), case.pop("thickness", 0.0))
    optics = {k: case.pop(k) for k in ("glass", "assembly") if k in case}
    nominal = datasets.get("ccd-slit").setups["nominal"].sensor
    assert isinstance(nominal, LineSensor)
    sensor = replace(
        nominal,
        camera=Camera(2.0, mask, nominal.camera.sun, **optics),
        axes=(axis,),
        spectrum=Spectrum((5.0,), (1.0,)),
        **{"errors": SlitErrors(), **case},
    )
    angles = ((0.0, 0.0), (20.0, -35.0), (-25.0, 10.0))
    found, true = lit(sensor, *angles), lit(replace(sensor, spectrum=None), *angles)
    # an edge's pattern moves light by about its width; a pixel is 14 um
    assert np.abs(found - true).max() < 0.02 * true.max()
    pixels = np.arange(found.shape[1])
    middles = [(p * pixels).sum(axis=1) / p.sum(axis=1) for p in (found, true)]
    assert np.abs(middles[0] - middles[1]).max() < 0.02
    assert found.sum(axis=1) == pytest.approx(true.sum(axis=1), rel=2e-3)


def test_light_of_a_slit_is_its_open_width_whatever_diffracts() -> None:
    """Fresnel's integral keeps energy; what lies beyond the array is ``lambda J / (2 pi^2 d)``."""
    for width in (0.03, 0.1, 0.3):
        sensor = aligned("ccd-slit", camera={"mask": slit_row((0.0,), width, 30.0)})
        found = lit(sensor, (0.0, 0.0), (40.0, 0.0)).sum(axis=1) * sensor.detector.pitch_mm
        points = sensor.camera.sun.directions(from_angles(np.array([0.0, 40.0]), np.zeros(2)))
        true = width * points[..., 2] @ sensor.camera.sun.quadrature()[1]
        spread = np.array([3.5, 3.5 / math.cos(math.radians(40.0))])
        beyond = 0.62e-3 * spread / (2 * math.pi**2 * (7.168 - width / 2)) * 2
        assert np.abs(true - beyond * true / width - found).max() < 2e-3 * width


def test_slits_of_one_shape_are_one_pattern_in_several_places() -> None:
    """A reticle is the sum of its slits, each alone."""
    sensor = aligned("ccd-periodic")
    mask = sensor.camera.mask
    alone = [
        lit(replace(sensor, camera=replace(sensor.camera, mask=Mask((a,)))), (17.0, -44.0))
        for a in mask.apertures
    ]
    assert lit(sensor, (17.0, -44.0)) == pytest.approx(sum(alone), rel=1e-12)


def test_no_light_comes_from_behind_or_through_a_closed_foil() -> None:
    sensor = aligned("ccd-slit", camera={"mask": slit_row((0.0,), 0.02, 16.0, 0.05)})
    assert not lit(sensor, (0.0, 60.0)).any()
    scene = Scene(np.array([[0.0, 0.6, -0.8], [0.0, 1.0, 0.0]]), np.ones(2), np.zeros(2))
    assert not sensor.lit(scene).any()
