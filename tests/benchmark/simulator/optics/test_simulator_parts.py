"""Light, optics, assembly, detectors and noise against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import toward
from scipy import integrate, stats

from benchmark.seeds import generator, seed_sequence
from benchmark.simulator.light.sun_disc import SolarDisc, tangent_axes
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.readout.detectors import (
    Quadrants,
    cosine_response,
    kelly_response,
)
from benchmark.simulator.readout.noise import NoiseStreams, draw_counts

angles = st.floats(-70.0, 70.0)


def off_axis(theta_deg: float) -> np.ndarray:
    theta = math.radians(theta_deg)
    return np.array([[math.sin(theta), 0.0, math.cos(theta)]])


@given(angles, angles)
@settings(deadline=None, derandomize=True)
def test_projection_angles_are_those_of_the_contract(alpha: float, beta: float) -> None:
    s = toward(alpha, beta)[0]
    assert np.linalg.norm(s) == pytest.approx(1.0, abs=1e-15)
    assert math.degrees(math.atan2(s[1], s[2])) == pytest.approx(alpha, abs=1e-12)
    assert math.degrees(math.atan2(s[0], s[2])) == pytest.approx(beta, abs=1e-12)


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(lambda v: np.linalg.norm(v) > 0.1))
@settings(deadline=None, derandomize=True)
def test_tangent_axes_make_right_handed_triads(vector: list[float]) -> None:
    s = np.array([vector]) / np.linalg.norm(vector)
    triad = np.stack([*tangent_axes(s), s])[:, 0]
    assert triad @ triad.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(triad) == pytest.approx(1.0)


def test_solar_quadrature_has_the_mass_and_spread_of_the_limb_darkened_disc() -> None:
    disc = SolarDisc(diameter_deg=0.533, limb_darkening=0.6)
    offsets, weights = disc.quadrature()
    assert weights.sum() == pytest.approx(1.0, abs=1e-14)
    assert weights @ offsets == pytest.approx([0.0, 0.0], abs=1e-17)
    radiance = lambda r: 1 - 0.6 * (1 - math.sqrt(max(1 - r * r, 0.0)))  # noqa: E731
    total = integrate.quad(lambda r: radiance(r) * r, 0, 1)[0]
    second = integrate.quad(lambda r: radiance(r) * r**3, 0, 1)[0] / total
    edge = math.sin(math.radians(0.533 / 2))
    assert weights @ np.sum(offsets**2, axis=1) == pytest.approx(second * edge**2, rel=2e-3)


def test_points_of_the_disc_are_unit_vectors_within_its_radius() -> None:
    sun = np.concatenate([toward(0, 0), toward(30, -50), np.array([[1.0, 0, 0], [0, 0, -1.0]])])
    points = SolarDisc().directions(sun)
    assert np.linalg.norm(points, axis=-1) == pytest.approx(1.0, abs=1e-14)
    apart = np.degrees(np.arccos(np.clip(np.einsum("nkj,nj->nk", points, sun), -1, 1)))
    assert apart.max() <= 0.533 / 2
    assert SolarDisc(diameter_deg=0.0).directions(sun)[:, 0] == pytest.approx(sun, abs=0)


def test_glass_thicker_than_the_gap_is_refused() -> None:
    with pytest.raises(ValueError, match=r"mask\b.*\b1\.2 mm"):
        CoverGlass((Plate(1.5, 1.5),)).displacement(off_axis(0), 1.2)


def test_assembly_turns_like_scipys_rotations() -> None:
    from scipy.spatial.transform import Rotation

    assembly = Assembly(tilt_x_deg=1.0, tilt_y_deg=-2.0, rotation_deg=3.0)
    sun = np.concatenate([toward(10, 20), toward(-40, 5)])
    expected = Rotation.from_euler("xyz", [1.0, -2.0, 3.0], degrees=True).apply(sun)
    assert assembly.to_head(sun) == pytest.approx(expected, abs=1e-14)
    assert Assembly().to_head(sun) is sun


def test_angular_responses_are_the_printed_ones() -> None:
    c = np.array([-1.0, -0.2, 0.0, 0.01, 0.3, 0.8, 1.0])
    assert cosine_response(c) == pytest.approx(np.maximum(c, 0))
    printed = -0.369 * c**3 + 0.637 * c**2 + 0.750 * c - 0.015
    assert kelly_response(c) == pytest.approx(np.where(c > 0, np.maximum(printed, 0), 0))
    assert kelly_response(np.array([1.0]))[0] == pytest.approx(1.003)


def test_quadrants_lie_where_the_voltage_balance_expects_them() -> None:
    middle = Quadrants(1.8, 0.1).boxes() @ np.array([[0.5, 0], [0.5, 0], [0, 0.5], [0, 0.5]])
    q1, q2, q3, q4 = np.sign(middle)
    assert (q2 + q3 - q1 - q4)[0] == 4
    assert (q1 + q2 - q3 - q4)[1] == 4


@pytest.mark.parametrize("mean", [0.5, 5.0, 19.9, 20.0, 400.0])
def test_shot_noise_has_variance_equal_to_the_mean(mean: float) -> None:
    streams = NoiseStreams.named("test", "shot", str(mean))
    electrons = draw_counts(np.full(200_000, mean), 0.0, streams)
    assert electrons.mean() == pytest.approx(mean, abs=5 * math.sqrt(mean / 2e5))
    assert electrons.var() == pytest.approx(mean, rel=0.02)


def test_small_counts_are_poisson() -> None:
    electrons = draw_counts(np.full(100_000, 3.0), 0.0, NoiseStreams.named("test", "poisson"))
    seen = np.bincount(np.rint(electrons).astype(int), minlength=12)[:12]
    assert np.abs(electrons - np.rint(electrons)).max() < 1e-6
    expected = stats.poisson.pmf(np.arange(12), 3.0) * 100_000
    assert np.sum((seen - expected) ** 2 / expected) < stats.chi2.ppf(0.999, 11)


def test_streams_are_told_apart_by_every_name_and_its_place() -> None:
    names = [("a", "bc"), ("ab", "c"), ("bc", "a"), ("a", "b", "c"), (1, "a"), ("1", "a")]
    states = {tuple(seed_sequence(*name).generate_state(4).tolist()) for name in names}
    assert len(states) == len(names)
    assert generator("a", 1).random() == generator("a", 1).random()
    with pytest.raises(ValueError, match="at least one name"):
        seed_sequence()
