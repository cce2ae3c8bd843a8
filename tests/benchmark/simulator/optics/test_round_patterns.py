"""Tables of round holes: the foil's two rims, the pixel, built sizes, rays through glass."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import lit_by
from scipy import integrate, optimize
from scipy.special import fresnel

from benchmark import datasets
from benchmark.simulator.kernels import diffraction
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.optics.diffraction import (
    SUNLIT_SILICON,
    Spectrum,
    lost_at_rims,
    round_intensity,
    round_skew,
)
from benchmark.simulator.optics.diffraction_tables import RoundPattern, landing_points
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.optics.table_grids import turned_cell
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

GREEN = Spectrum((550.0,), (1.0,))
TWO = Spectrum((500.0, 620.0), (0.5, 0.5))
UP = np.array([[0.0, 0.0, 1.0]])
GRIDS = ["cmos-multi-aperture", "ccd-multi-aperture", "cmos-encoded", "cmos-compound-eye"]
#: As masks of the standard data sets are built.
BUILT = MaskErrors(position_mm=0.001, size_mm=0.001, edge_mm=0.0005)


def sensor_of(width_mm: float, height_mm: float = 1.0, **fields) -> MultiSpotSensor:
    """One hole above the middle of 64 x 64 px of 10 um, under two colours."""
    base = datasets.get("cmos-multi-aperture").setups["nominal"].sensor
    assert isinstance(base, MultiSpotSensor)
    mask = Mask((Aperture("round", width_mm, width_mm),))
    detector = replace(base.detector, columns=64, rows=64)
    fields = {"spectrum": TWO, "widest_deg": 45.0, **fields}
    return MultiSpotSensor(Camera(height_mm, mask), detector, **fields)


@pytest.mark.parametrize("apart", [0.02, 0.4, 1.3])
@pytest.mark.parametrize("numbers", [(0.4, 0.9), (2.5, 6.0)])
def test_two_displaced_rims_leave_the_integral_over_their_lens(apart, numbers) -> None:
    """Quadrature over strips of the lens along x, which has other strips than the sum."""
    x, y = np.array([0.0, 0.55, 1.3]), np.array([0.0, 0.8])
    nodes, shares = np.polynomial.legendre.leggauss(160)
    top = math.sqrt(1.0 - apart**2 / 4.0)
    # strips at height p: half width sqrt(1 - p^2) - apart / 2; p = top sin(psi) smooths the tips
    psi = math.pi / 2.0 * nodes
    p = top * np.sin(psi)
    half = np.sqrt(1.0 - p**2) - apart / 2.0
    q = half[:, None] * nodes
    weights = (math.pi / 2.0 * shares * top * np.cos(psi) * half)[:, None] * shares
    found = round_intensity(x, y, numbers, apart=apart)
    for i in range(3):
        for j in range(2):
            phase = numbers[0] * (x[i] - q) ** 2 + numbers[1] * (y[j] - p[:, None]) ** 2
            field = np.sum(weights * np.exp(1j * math.pi * phase))
            assert found[i, j] == pytest.approx(numbers[0] * numbers[1] * abs(field) ** 2, abs=1e-7)


@pytest.mark.parametrize("apart", [0.0, 0.4])
def test_the_cubic_phase_changes_light_by_its_first_order(apart: float) -> None:
    """Quadrature over the lens with the cubic phase, and the amplitude that goes with it."""
    x, y, numbers = np.array([-0.7, 0.2, 1.3]), np.array([0.0, 0.8]), (0.3, 0.45)
    third, beside = 0.03, 0.02
    nodes, shares = np.polynomial.legendre.leggauss(120)
    psi = math.pi / 2.0 * nodes
    top = math.sqrt(1.0 - apart**2 / 4.0)
    p = top * np.sin(psi)
    half = np.sqrt(1.0 - p**2) - apart / 2.0
    q = half[:, None] * nodes
    weights = (math.pi / 2.0 * shares * top * np.cos(psi) * half)[:, None] * shares

    def light(i: int, j: int, step: float) -> float:
        rho, tau = x[i] - q, y[j] - p[:, None]
        phase = numbers[0] * rho**2 * (1.0 - step * third * rho)
        phase = phase + numbers[1] * tau**2 * (1.0 - step * beside * rho)
        less = 1.0 - step * (3.0 * third + beside) / 2.0 * rho
        field = np.sum(weights * less * np.exp(1j * math.pi * phase))
        return numbers[0] * numbers[1] * abs(field) ** 2

    intensity, found = round_skew(x, y, numbers, (third, beside, 0.0, 0.0), apart=apart)
    # the light itself, which another kernel sums
    assert intensity == pytest.approx(round_intensity(x, y, numbers, apart=apart), rel=1e-12)
    for i in range(3):
        for j in range(2):
            expected = (light(i, j, 1e-3) - light(i, j, -1e-3)) / 2e-3
            # farther waves are faded out: 4e-4 of it here
            assert found[i, j] == pytest.approx(expected, abs=2e-5)


@pytest.mark.parametrize("displaced", [0.0, 0.3, 1.0, 2.5])
def test_rims_take_the_light_of_fresnels_shadow(displaced: float) -> None:
    """The integral of its amplitude, damped far out, where it swings about nothing."""

    def amplitude(u: float) -> complex:
        sine, cosine = fresnel(u)
        return complex(0.5 - cosine + 1j * (0.5 - sine)) / (1.0 + 1j)

    # the tail swings as exp(i pi u^2 / 2) i / (pi u): its integral from U on is of order U^-2
    end = 40.0
    parts = [
        integrate.quad(lambda u, f=f: f(amplitude(u)), displaced, end, limit=2000)[0]
        for f in (np.real, np.imag)
    ]
    [found] = lost_at_rims(np.array([displaced]))
    assert found == pytest.approx(complex(*parts), abs=1.0 / (math.pi**2 * end**2) + 1e-6)


@pytest.mark.slow
def test_rims_take_as_much_light_as_passes_the_one_and_hits_the_other() -> None:
    """Fresnel's field a foil's thickness behind a hole, by its boundary wave, within the same hole.

    An edge moved inwards by ``blur Re(lost)`` radii all around takes twice that share.
    """
    radius, foil, wave = 0.05, 0.01, 550e-6
    rings, shares = np.polynomial.legendre.leggauss(1500)
    place = radius * (rings + 1.0) / 2.0
    turn = 2.0 * math.pi * (np.arange(6000) + 0.5) / 6000
    passed = 0.0
    for r, share in zip(place, shares, strict=True):
        # from a point inside the hole rays run to the rim, each integrated in closed form
        rim = np.sqrt(radius**2 - (r * np.sin(turn)) ** 2) - r * np.cos(turn)
        field = 1.0 - np.mean(np.exp(1j * math.pi / (wave * foil) * rim**2))
        passed += share * r / radius * abs(field) ** 2
    blur = math.sqrt(wave * foil / 2.0) / radius
    [lost] = lost_at_rims(np.zeros(1))
    assert 1.0 - passed == pytest.approx(2.0 * blur * lost.real, rel=0.01)


def test_a_turned_cell_has_the_moments_of_a_square_whichever_way() -> None:
    places, weights = turned_cell(5)
    x, y = places.T
    assert weights.sum() == pytest.approx(1.0, abs=1e-14)
    assert weights @ x == pytest.approx(0.0, abs=1e-15)
    assert weights @ x**2 == pytest.approx(1.0 / 12.0, rel=1e-12)
    assert weights @ (x * y) == pytest.approx(0.0, abs=1e-15)
    # the mean over turns of 1/80 (c^4 + s^4) + 6/144 c^2 s^2
    assert weights @ x**4 == pytest.approx(3.0 / 320.0 + 6.0 / 144.0 / 8.0, rel=1e-12)


def pattern_of(**fields) -> RoundPattern:
    given = {
        "radius_mm": 0.04,
        "height_mm": 1.0,
        "glass": CoverGlass(),
        "sun": SolarDisc(),
        "spectrum": GREEN,
        "reach_mm": 0.12,
        "widest_deg": 60.0,
    }
    return RoundPattern(**{**given, **fields})


@pytest.mark.parametrize("thickness", [0.0, 0.01])
def test_incidences_between_those_tabulated_are_interpolated(thickness: float) -> None:
    pattern = pattern_of(thickness_mm=thickness)
    last, reach = pattern.nodes - 1, pattern.tables().shape[2] - 1
    angles = np.radians(60.0 * np.arange(last + 1) / last)
    tables = np.array([pattern._table(math.sin(angle), reach) for angle in angles])
    _, units = pattern.scales(np.sin(np.radians(60.0 * (np.arange(3) + 0.5) * 3.0 / last)))
    for k in range(3):
        place = 0.5 + 3.0 * k
        exact = pattern._table(math.sin(math.radians(60.0 * place / last)), reach)
        found = np.empty(tables.shape[1:])
        diffraction._blend(found, tables, place, 0.0)
        assert np.abs(found - exact).max() < 5e-3 * exact.max(), (place, units)


@pytest.mark.slow
def test_a_hole_between_two_tabulated_ones_is_that_hole() -> None:
    """Built 1 um wider than drawn, against a mask that is drawn that wide."""
    sun = from_angles(np.array([5.0]), np.array([-8.0]))
    drawn = sensor_of(0.1, errors=BUILT)
    wide = sensor_of(0.101)
    pattern = dict(wide.fixed_pattern("test"))
    found = drawn.lit(lit_by(sun), pattern)
    expected = wide.lit(lit_by(sun), pattern)
    assert np.abs(found - expected).max() < 1e-3 * expected.max()


@pytest.mark.slow
def test_a_unit_two_deviations_off_shows_holes_of_its_own_size() -> None:
    """The holes and the light of ccd-multi-aperture, against masks that are drawn so."""
    sun = from_angles(np.array([0.0, 10.0, 18.0]), np.array([0.0, -12.0, 5.0]))
    drawn = sensor_of(0.05, 0.75, errors=BUILT, spectrum=SUNLIT_SILICON)
    for off in (-2.0 * BUILT.size_mm, 2.0 * BUILT.size_mm):
        built = sensor_of(0.05 + off, 0.75, spectrum=SUNLIT_SILICON)
        pattern = dict(built.fixed_pattern("test"))
        found = drawn.lit(lit_by(sun), pattern)
        expected = built.lit(lit_by(sun), pattern)
        worst = np.abs(found - expected).max(axis=(1, 2)) / expected.max(axis=(1, 2))
        assert worst.max() < 2e-3, (off, worst)


@pytest.mark.parametrize("name", GRIDS)
def test_tables_of_three_sizes_hold_those_of_every_unit(name: str) -> None:
    """At normal incidence, where light depends most on the size; units two deviations off."""
    sensor = datasets.get(name).setups["nominal"].sensor
    assert isinstance(sensor, MultiSpotSensor)
    off = 2.0 * sensor.errors.radius_mm
    for width in sorted({aperture.width_mm for aperture in sensor.camera.mask.apertures})[::5]:
        sizes = sensor._spots.sizes(width)
        small, drawn, large = (size._table(0.0, 60) for size in sizes)
        for place in (-2.0 * off / width, 2.0 * off / width):
            exact = replace(sizes[1], growth=place)._table(0.0, 60)
            x = place / sizes[2].growth
            bent = drawn + x / 2.0 * (large - small) + x * x / 2.0 * (large - 2.0 * drawn + small)
            assert np.abs(bent - exact).max() < 2e-3 * exact.max(), (width, place)


@pytest.mark.slow
def test_holes_of_several_built_sizes_are_those_holes() -> None:
    base = sensor_of(0.1, errors=BUILT)
    mask = Mask(
        (Aperture("round", 0.1, 0.1, x_mm=-0.2), Aperture("round", 0.1, 0.1, x_mm=0.2)),
    )
    pair = replace(base, camera=replace(base.camera, mask=mask))
    pattern = dict(replace(pair, errors=MaskErrors()).fixed_pattern("test"))
    table = pattern["apertures"].copy()
    table[:, 3:5] += np.array([[0.05], [-0.05]])  # half a micrometre either way
    pattern["apertures"] = table
    found = pair.lit(lit_by(UP), pattern)
    expected = np.zeros(found.shape)
    for n, width in enumerate((0.101, 0.099)):
        one = Mask((Aperture("round", width, width, x_mm=-0.2 + 0.4 * n),))
        single = replace(sensor_of(0.1), camera=replace(base.camera, mask=one))
        expected += single.lit(lit_by(UP), single.fixed_pattern("test"))
    assert np.abs(found - expected).max() < 1e-3 * expected.max()


@pytest.mark.slow
def test_one_averaged_cell_is_a_pixel_of_many() -> None:
    data = datasets.get("ccd-multi-aperture")
    sensor = data.setups["nominal"].sensor
    assert isinstance(sensor, MultiSpotSensor)
    one = replace(sensor_of(0.05, 0.75), detector=replace(sensor.detector, columns=48, rows=48))
    sun = from_angles(np.array([20.0]), np.array([20.0]))
    moved = Mask((replace(one.camera.mask.apertures[0], x_mm=-0.27, y_mm=-0.27),))
    one = replace(one, camera=replace(one.camera, mask=moved))
    fine = replace(
        one, detector=replace(one.detector, columns=192, rows=192, pitch_mm=0.003), skirt=1e-5
    )
    found = one.lit(lit_by(sun), one.fixed_pattern("test"))[0]
    expected = fine.lit(lit_by(sun), fine.fixed_pattern("test"))[0]
    expected = expected.reshape(48, 4, 48, 4).mean(axis=(1, 3))
    assert np.abs(found - expected).max() < 5e-3 * expected.max()


def test_light_left_out_is_below_the_stated_share() -> None:
    sun = from_angles(np.array([0.0, 25.0]), np.array([0.0, 10.0]))
    near, far = (replace(sensor_of(0.05), skirt=skirt) for skirt in (1e-3, 1e-6))
    scene, pattern = lit_by(sun), near.fixed_pattern("test")
    here, there = near.lit(scene, pattern), far.lit(scene, pattern)
    out = (here == 0.0) & (there > 0.0)
    assert out.any()
    # the stated share is a mean over rings, the brightest of which have twice of it
    assert there[out].max() < 2.5e-3 * there[0].max()


def looked_up_at(x: float, y: float, way: np.ndarray) -> tuple[float, float]:
    """Row and column of a table for a point, of the weights of the nodes -1, 0, 1 and 2 there."""
    work = np.zeros(13 * diffraction._W)
    work[0] = x
    diffraction._look(work, y, 1.0, way, 10**6)
    row, column, *weights = work[:: diffraction._W][1:11]
    nodes = np.arange(-1.0, 3.0)
    return row + nodes @ weights[:4], column + nodes @ weights[4:]


@pytest.mark.parametrize("angle", [12.0, 45.0, 65.0])
@pytest.mark.parametrize("plates", [(), (Plate(0.5, 1.52),), (Plate(0.3, 1.5), Plate(0.4, 1.9))])
def test_far_patterns_are_seen_where_light_has_turned(
    plates: tuple[Plate, ...], angle: float
) -> None:
    """By how much: from the sine of the ray that lands there, found by bisection.

    Behind a hole of 4 um patterns are round in direction cosines. Left out are terms of the third
    order in the distance over the height; those of the second come to 0.03 of it.
    """
    pattern = pattern_of(
        radius_mm=0.002, height_mm=1.2, glass=CoverGlass(plates), widest_deg=70.0, reach_mm=0.1
    )
    stack = pattern.layers()
    sine = np.array([math.sin(math.radians(angle))])
    steps, _ = pattern.scales(sine)
    numbers = np.concatenate([[1.0, 0.0], 1.0 / steps[0], pattern.seen(sine)[0]])
    way = diffraction._way(np.array([sine[0], 0.0, math.sqrt(1.0 - sine[0] ** 2)]), numbers, stack)
    [chief] = landing_points(sine, stack)[:, 0]
    for turn in np.radians([0.0, 70.0, 130.0, 180.0]):
        x, y = 0.02 * math.cos(turn), 0.02 * math.sin(turn)
        out = math.hypot(chief + x, y)
        arriving = optimize.brentq(
            lambda s, r=out: landing_points(np.array([s]), stack)[0, 0] - r, 0, 0.99
        )
        turned = math.hypot(arriving * (chief + x) / out - sine[0], arriving * y / out)
        row, column = looked_up_at(chief + x, y, way)
        found = math.hypot(row * steps[0, 0], column * steps[0, 1])
        assert found == pytest.approx(turned, rel=2e-3)
