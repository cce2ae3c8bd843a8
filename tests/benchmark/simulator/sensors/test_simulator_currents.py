"""Quadrants and faces against exact geometry; exact areas against other ways to compute them."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import lit_by
from scipy import integrate

from benchmark.seeds import generator
from benchmark.simulator.kernels.areas import convex_area
from benchmark.simulator.light.environment import Earth, uniform_direction
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import CurrentReadout, Quadrants
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.sensors.faces import CUBE, FaceSensor
from benchmark.simulator.sensors.quadrants import QuadrantSensor

IDEAL = CurrentReadout(
    sunlit_ua=100.0, gain_mismatch=0.0, noise_ua=0.0, full_scale_ua=200.0, bits=24
)
POINT = SolarDisc(diameter_deg=0.0)
NO_DISCS = np.empty((0, 3))


def box(x0: float, x1: float, y0: float, y1: float) -> np.ndarray:
    return np.array([[-1.0, 0, -x0], [1, 0, x1], [0, -1, -y0], [0, 1, y1]])


def square_quadrants(gap: float = 0.0, shape: str = "rectangle") -> QuadrantSensor:
    mask = Mask((Aperture(shape, 2.0, 2.0),))
    return QuadrantSensor(Camera(1.0, mask, POINT), Quadrants(2.0, gap), IDEAL)


def balances(currents: np.ndarray) -> np.ndarray:
    q1, q2, q3, q4 = currents.T
    return np.stack([q2 + q3 - q1 - q4, q1 + q2 - q3 - q4], axis=1) / currents.sum(axis=1)[:, None]


coordinate = st.floats(-2.0, 2.0).map(lambda value: round(value, 3))


@given(coordinate, coordinate, st.floats(0.2, 2.0), coordinate, coordinate)
@settings(deadline=None, derandomize=True, max_examples=60)
def test_area_of_a_disc_in_a_box_is_the_integral_of_its_chords(
    x: float, y: float, radius: float, x0: float, y0: float
) -> None:
    x1, y1 = x0 + 1.3, y0 + 0.9

    def chord(height: float) -> float:
        half = math.sqrt(max(radius**2 - (height - y) ** 2, 0.0))
        return max(min(x1, x + half) - max(x0, x - half), 0.0)

    # between the heights where the rim starts, ends or meets a side, the chord is smooth
    meets = [math.sqrt(max(radius**2 - (side - x) ** 2, 0.0)) for side in (x0, x1)]
    bends = [y + sign * reach for reach in (radius, *meets) for sign in (-1, 1)]
    steps = sorted({y0, y1, *(bend for bend in bends if y0 < bend < y1)})
    expected = sum(
        integrate.quad(chord, a, b, epsabs=1e-9)[0] for a, b in itertools.pairwise(steps)
    )
    area = convex_area(box(x0, x1, y0, y1), np.array([[x, y, radius]]))
    assert area == pytest.approx(expected, abs=1e-5)


@given(st.floats(0.0, 2.5), st.floats(0, 360))
@settings(deadline=None, derandomize=True)
def test_area_of_two_discs_is_the_lens(apart: float, azimuth: float) -> None:
    x, y = apart * math.cos(math.radians(azimuth)), apart * math.sin(math.radians(azimuth))
    d = min(apart, 2.0)
    lens = 2 * math.acos(d / 2) - d / 2 * math.sqrt(max(4 - d * d, 0.0))
    discs = np.array([[0.3, -0.2, 1.0], [0.3 + x, -0.2 + y, 1.0]])
    assert convex_area(np.empty((0, 3)), discs) == pytest.approx(lens, abs=1e-7)


@given(st.floats(0, 90), coordinate, coordinate)
@settings(deadline=None, derandomize=True)
def test_area_of_a_turned_square_in_a_box_is_that_of_the_clipped_polygon(
    turn: float, x: float, y: float
) -> None:
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    corners = [
        (x + c * a - s * b, y + s * a + c * b) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
    ]
    u, v = c * x + s * y, c * y - s * x
    lines = np.array([[c, s, u + 1], [-c, -s, 1 - u], [-s, c, v + 1], [s, -c, 1 - v]])
    window = box(-0.7, 1.1, -0.4, 1.5)
    polygon = corners
    for a, b, limit in window:  # Sutherland-Hodgman
        clipped = []
        for (px, py), (qx, qy) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
            p, q = a * px + b * py - limit, a * qx + b * qy - limit
            if p <= 0:
                clipped.append((px, py))
            if (p < 0 < q) or (q < 0 < p):
                clipped.append((px + (qx - px) * p / (p - q), py + (qy - py) * p / (p - q)))
        polygon = clipped
    expected = 0.5 * abs(
        sum(
            px * qy - qx * py
            for (px, py), (qx, qy) in zip(polygon, polygon[1:] + polygon[:1], strict=True)
        )
    )
    assert convex_area(np.vstack([window, lines]), NO_DISCS) == pytest.approx(expected, abs=1e-9)


def test_touching_from_outside_is_no_overlap() -> None:
    disc = np.array([[0.0, 0.5, 0.25]])
    assert convex_area(box(0.25, 1.5, 0.0, 0.9), disc) == 0.0
    assert convex_area(box(-0.25, 0.25, 0.25, 0.75), disc) == pytest.approx(math.pi / 16)
    beside = np.vstack([disc, [[0.5, 0.5, 0.25]]])
    assert convex_area(np.empty((0, 3)), beside) == pytest.approx(0.0, abs=1e-12)


@given(st.floats(-44, 44), st.floats(-44, 44))
@settings(deadline=None, derandomize=True)
def test_balance_of_a_square_spot_is_linear_in_the_tangent_and_inverts(
    alpha: float, beta: float
) -> None:
    """alg:VB with tan(alpha_max) = d / (2 h) = 1; no gap, point Sun, no noise: exact."""
    sensor = square_quadrants()
    sun = from_angles(np.array([alpha]), np.array([beta]))
    s_a, s_b = balances(sensor.expected(lit_by(sun), sensor.fixed_pattern("test")))[0]
    assert math.degrees(math.atan(s_a)) == pytest.approx(beta, abs=1e-6)
    assert math.degrees(math.atan(s_b)) == pytest.approx(alpha, abs=1e-6)


def test_balance_of_a_round_spot_bends() -> None:
    sensor = square_quadrants(shape="round")
    beta = np.array([1.0, 30.0])
    sun = from_angles(np.zeros(2), beta)
    s_a = balances(sensor.expected(lit_by(sun), sensor.fixed_pattern("test")))[:, 0]
    x = np.tan(np.radians(beta))  # spot displacement over its radius
    exact = 2 / math.pi * (np.arcsin(x) + x * np.sqrt(1 - x**2))
    assert s_a == pytest.approx(exact, abs=1e-9)


def test_gap_and_edge_take_their_light_away() -> None:
    centred = np.array([[0.0, 0.0, 1.0]])
    sensor = square_quadrants(gap=0.2)
    light = sensor.lit(lit_by(centred)).sum()
    assert light == pytest.approx(4 * 0.9**2 / 4)
    small = replace(sensor, detector=Quadrants(half_width_mm=1.5, gap_mm=0.0))
    sun = from_angles(np.array([0.0]), np.array([40.0]))
    x = math.tan(math.radians(40.0))
    assert small.lit(lit_by(sun)).sum() == pytest.approx((1.5 - (x - 1)) / 2 * sun[0, 2])


def test_a_thick_square_mask_dims_by_the_overlap_of_its_rims() -> None:
    mask = Mask((Aperture("rectangle", 2.0, 2.0),), thickness_mm=0.3)
    sensor = replace(square_quadrants(), camera=Camera(1.0, mask, POINT))
    sun = from_angles(np.array([20.0]), np.array([-30.0]))
    shift = 0.3 * np.tan(np.radians([20.0, 30.0]))
    expected = np.prod(2.0 - shift) / 4 * sun[0, 2]
    assert sensor.lit(lit_by(sun)).sum() == pytest.approx(expected)


def test_converter_rounds_to_codes_and_clips() -> None:
    readout = CurrentReadout(100.0, 0.0, 0.0, full_scale_ua=8.0, bits=4)
    mean = np.array([[-9.0, -0.4, 0.6, 3.4, 99.0]])
    out = FaceSensor(CUBE, readout).read(mean, NoiseStreams.named("test"))
    assert out.tolist() == [[-8.0, 0.0, 1.0, 3.0, 7.0]]
    assert not np.signbit(out[0, 1])


def test_photodiode_noise_is_shot_plus_amplifier() -> None:
    readout = CurrentReadout(
        100.0, 0.0, noise_ua=0.003, full_scale_ua=200.0, bits=30, integration_s=1e-12
    )
    sensor, mean = FaceSensor(CUBE, readout), np.full((100_000, 1), 50.0)
    seen = sensor.read(mean, NoiseStreams.named("test", "currents"))
    shot = 1.602176634e-19 * 50e-6 / 1e-12 * 1e12  # q I / T, square microamperes
    assert seen.var() == pytest.approx(shot + 0.003**2, rel=0.02)
    assert sensor.variance(mean)[0, 0] == pytest.approx(shot + 0.003**2, rel=1e-6)


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(lambda v: np.linalg.norm(v) > 0.1))
@settings(deadline=None, derandomize=True)
def test_six_cosine_currents_are_inverted_exactly(vector: list[float]) -> None:
    """eq:msfstd, from opposite faces' differences; point Sun, no noise."""
    sun = np.array([vector]) / np.linalg.norm(vector)
    sensor = FaceSensor(CUBE, IDEAL, response="cosine", sun=POINT)
    currents = sensor.expected(lit_by(sun), sensor.fixed_pattern("test"))[0]
    found = currents[::2] - currents[1::2]
    apart = np.cross(found / np.linalg.norm(found), sun[0])
    assert math.degrees(np.linalg.norm(apart)) < 1e-6


def test_finite_disc_keeps_the_cosine_law_away_from_the_limb_and_lights_grazing_faces() -> None:
    sensor = FaceSensor(CUBE, IDEAL, response="cosine")
    pattern = sensor.fixed_pattern("test")
    sun = np.array([[0.6, 0.48, 0.64], [1.0, 0.0, 0.0]])
    light = sensor.lit(lit_by(sun), pattern)
    shrink = light[1, 0]  # mean of the cosine over the disc
    assert 0.99999 < shrink < 1.0
    assert light[0, ::2] == pytest.approx(shrink * sun[0])
    assert light[1, 2:] == pytest.approx(light[1, 2])  # Sun in four face planes: half a disc each
    assert 0 < light[1, 2] < math.sin(math.radians(0.533 / 2)) / 2


def test_built_normals_miss_the_nominal_ones_by_the_stated_angle() -> None:
    normals = tuple(uniform_direction(generator("test", n)) for n in range(3000))
    sensor = FaceSensor(normals, IDEAL, normal_error_deg=2.0)
    built = sensor.fixed_pattern("test")["normals"]
    apart = np.degrees(np.arccos(np.clip(np.sum(built * np.array(normals), axis=1), -1, 1)))
    assert math.sqrt(np.mean(apart**2) / 2) == pytest.approx(2.0, rel=0.05)


def test_full_earth_from_far_away_shines_like_a_lambert_sphere() -> None:
    """Geometric albedo 2/3 of the reflectance: irradiance (2/3) rho (R/r)^2 at full phase."""
    earth = Earth(reflectance=0.3, altitude_km=1e7, rings=64, spokes=64)
    sun, nadir = np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, -1.0]])
    light = earth.response(sun, nadir, np.array([[0.0, 0, -1.0], [0, 0, 1.0]]), "cosine")
    distance = earth.radius_km + earth.altitude_km
    assert light[0, 0] == pytest.approx(2 / 3 * 0.3 * (earth.radius_km / distance) ** 2, rel=1e-3)
    assert light[0, 1] == 0.0


@pytest.mark.parametrize("phase_deg", [pytest.param(0.0, marks=pytest.mark.slow), 60.0, 100.0])
def test_earthlight_is_the_sum_over_the_visible_lit_ground(phase_deg: float) -> None:
    earth = Earth(rings=24, spokes=96)
    phase = math.radians(phase_deg)
    up = np.array([0.0, 0.0, 1.0])  # Earth's centre at the origin, craft on +z
    sun = np.array([math.sin(phase), 0.0, math.cos(phase)])
    normals = np.array([[0, 0, -1.0], [1, 0, 0], [0, 1, 0], [0.6, 0, -0.8]])
    z = (np.arange(4000) + 0.5) / 4000 * 0.2 + 0.8  # the cap seen from 600 km starts at 0.914
    turn = (np.arange(360) + 0.5) / 360 * 2 * math.pi
    zz, tt = np.meshgrid(z, turn)
    root = np.sqrt(1 - zz**2)
    ground = np.stack([root * np.cos(tt), root * np.sin(tt), zz], axis=-1).reshape(-1, 3)
    away = earth.radius_km * ground - (earth.radius_km + earth.altitude_km) * up
    distance = np.linalg.norm(away, axis=1)
    sight = away / distance[:, None]
    area = earth.radius_km**2 * 0.2 * 2 * math.pi / len(ground)
    seen = np.maximum(-np.sum(sight * ground, axis=1), 0)
    lit = np.maximum(ground @ sun, 0)
    patch = 0.3 / math.pi * lit * seen * area / distance**2
    expected = [np.sum(patch * np.maximum(sight @ n, 0)) for n in normals]
    found = earth.response(sun[None], -up[None], normals, "cosine")[0]
    assert found == pytest.approx(expected, rel=0.01, abs=2e-4)


def test_albedo_samples_all_see_the_sun() -> None:
    earth = Earth()
    sun = np.array([uniform_direction(generator("test", "sun", n)) for n in range(500)])
    nadir = earth.draw_nadir(sun, generator("test", "nadir"))
    assert np.linalg.norm(nadir, axis=1) == pytest.approx(1.0)
    apart = np.degrees(np.arccos(np.clip(np.sum(sun * nadir, axis=1), -1, 1)))
    assert apart.min() > earth.half_angle_deg
    assert apart.max() > 150
