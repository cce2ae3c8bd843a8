"""Recursive posterior bounds against closed forms, and a Kalman filter that reaches them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.conditions.flight_bounds import HORIZON, MAGNETOMETER, posterior_bound
from benchmark.metrics.posterior_bound import (
    Motion,
    attitude_information,
    recursive_bound,
    single_bound,
    sun_information,
    vector_information,
)
from benchmark.simulator.flight.gyro import Gyro

SIGMA = 1e-3  # radians a tangent axis
STEP_S = 10.0


def at_rest(count: int, gyro: Gyro) -> tuple[np.ndarray, np.ndarray, Motion]:
    sun = np.tile([0.0, 0.0, 1.0], (count, 1))
    information = attitude_information(sun, np.tile(np.eye(2) / SIGMA**2, (count, 1, 1)))
    turn = np.tile(np.eye(3), (count, 1, 1))
    return sun, information, Motion(turn, STEP_S * np.arange(count), gyro)


def test_a_body_known_to_be_still_averages() -> None:
    found = recursive_bound(*at_rest(50, Gyro(0.0, 0.0, 0.0)))
    expected = np.degrees(math.sqrt(2.0) * SIGMA / np.sqrt(np.arange(1.0, 51.0)))
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_a_random_walk_settles_at_its_riccati_equation() -> None:
    found = recursive_bound(*at_rest(400, Gyro(0.6, 0.0, 0.0)))
    q = math.radians(0.6) ** 2 * STEP_S / 3600.0
    before = (q + math.sqrt(q**2 + 4.0 * q * SIGMA**2)) / 2.0
    after = before * SIGMA**2 / (before + SIGMA**2)
    assert found[-1] == pytest.approx(math.degrees(math.sqrt(2.0 * after)), rel=1e-6)


def test_in_the_dark_a_known_bias_leaves_the_random_walk() -> None:
    sun, information, motion = at_rest(60, Gyro(0.6, 0.0, 0.0))
    information[:10], information[30:] = 0.0, 0.0
    found = np.radians(recursive_bound(sun, information, motion)) ** 2
    assert np.isinf(found[:10]).all()
    q = math.radians(0.6) ** 2 * STEP_S / 3600.0
    np.testing.assert_allclose(np.diff(found[29:]), 2.0 * q, rtol=1e-6)


def test_an_exact_kalman_filter_reaches_the_bound_of_a_bias_that_wanders() -> None:
    """A filter written axis by axis for a body at rest, over drawn flights."""
    gyro, count, runs = Gyro(0.6, 20.0, 5.0), 80, 4000
    found = recursive_bound(*at_rest(count, gyro))
    rng = np.random.default_rng(1)
    walk = math.radians(gyro.bias_walk_deg_h_sqrt_h) / 3600.0**1.5 * math.sqrt(STEP_S)
    white = math.radians(gyro.angle_random_walk_deg_sqrt_h) * math.sqrt(STEP_S / 3600.0)
    first = math.radians(gyro.bias_deg_h) / 3600.0
    bias = first * rng.standard_normal((runs, 2))
    angle, guess_bias = np.zeros((runs, 2)), np.zeros((runs, 2))
    p = np.diag([4.0 * math.pi**2, first**2])
    for n in range(count):
        if n:
            bias += walk * rng.standard_normal(bias.shape)
            rate = bias * STEP_S + white * rng.standard_normal(bias.shape)
            angle = angle + (rate - guess_bias * STEP_S) * -1.0
            move = np.array([[1.0, -STEP_S], [0.0, 1.0]])
            p = move @ (p + np.diag([0.0, walk**2])) @ move.T + np.diag([white**2, 0.0])
        gain = p[:, 0] / (p[0, 0] + SIGMA**2)
        # `angle` is truth less guess
        seen = angle + SIGMA * rng.standard_normal(angle.shape)
        angle, guess_bias = angle - gain[0] * seen, guess_bias + gain[1] * seen
        p -= np.outer(gain, p[0])
    assert found[-1] == pytest.approx(np.degrees(np.sqrt((angle**2).sum(axis=1).mean())), rel=0.03)


def test_other_vectors_tell_the_turn_about_the_sun_and_across_it() -> None:
    sun, information, _ = at_rest(1, Gyro())
    alone = single_bound(sun, information)
    across = single_bound(sun, information + vector_information(np.array([[1.0, 0, 0]]), SIGMA))
    along = single_bound(sun, information + vector_information(np.array([[0, 0, 1.0]]), SIGMA))
    assert alone[0] == pytest.approx(math.degrees(math.sqrt(2.0) * SIGMA), rel=1e-6)
    assert across[0] == pytest.approx(math.degrees(math.sqrt(1.5) * SIGMA), rel=1e-5)
    assert along[0] == pytest.approx(math.degrees(SIGMA), rel=1e-5)


def test_matrices_give_the_bound_of_one_sample_and_more_is_never_worse() -> None:
    preset = datasets.get("pd-orbit")
    single = preset.bound("nominal")
    assert single.fisher is not None
    seen = single.observable
    variance = np.linalg.inv(sun_information(single.fisher, irradiance_known=False)[seen])
    angle = np.degrees(np.sqrt(np.trace(variance, axis1=1, axis2=2)))
    np.testing.assert_allclose(angle, single.angle_deg[seen], rtol=1e-6)
    plain = frozenset({"rate_deg_s", "nadir"})
    assert posterior_bound(preset, "nominal", plain, sequential=False, bound=single) is None
    still = datasets.get("pd-maskless-cube")
    assert posterior_bound(still, "nominal", plain, sequential=True) is None
    found = posterior_bound(preset, "nominal", plain, sequential=True, bound=single)
    more = plain | MAGNETOMETER | HORIZON
    fused = posterior_bound(preset, "nominal", more, sequential=True, bound=single)
    alone = posterior_bound(preset, "nominal", more, sequential=False, bound=single)
    assert found is not None
    assert fused is not None
    assert alone is not None
    assert (found[seen] <= single.angle_deg[seen]).all()
    assert (alone[seen] <= single.angle_deg[seen] * (1 + 1e-9)).all()
    both = np.isfinite(found)
    assert (fused[both] <= found[both] * (1 + 1e-9)).all()


def test_in_the_dark_a_wandering_bias_adds_up_twice() -> None:
    """Of n steps, the bias drawn in the k-th moves the angle in all n - k + 1 that follow."""
    sun, information, motion = at_rest(30, Gyro(0.0, 0.0, 20.0))
    information[1:] = 0.0
    found = np.radians(recursive_bound(sun, information, motion)) ** 2
    step = (math.radians(20.0) / 3600.0**1.5) ** 2 * STEP_S
    n = np.arange(30.0)
    moved = step * STEP_S**2 * n * (n + 1) * (2 * n + 1) / 6
    np.testing.assert_allclose(found - found[0], 2.0 * moved, rtol=1e-6, atol=1e-15)


def test_in_the_dark_a_body_that_spins_spreads_a_constant_bias_round() -> None:
    """Integral in closed form: across the axis a bias turns with the body, along it, it adds up."""
    count, rate, gyro = 40, 0.03, Gyro(0.0, 10.0, 0.0)  # two turns and a half in all
    time_s = STEP_S * np.arange(count)
    angle = rate * time_s
    cos, sin, nought, one = np.cos(angle), np.sin(angle), np.zeros(count), np.ones(count)
    # from the inertial frame to that of a body turning about z; the Sun is at x of the inertial one
    turn = np.array([[cos, sin, nought], [-sin, cos, nought], [nought, nought, one]])
    turn = np.moveaxis(turn, 2, 0)
    information = np.zeros((count, 3, 3))
    information[0] = np.eye(3) / SIGMA**2
    found = recursive_bound(turn[:, :, 0], information, Motion(turn, time_s, gyro))
    bias = math.radians(10.0) / 3600.0
    across = (2.0 - 2.0 * cos) / rate**2  # |integral of the bias's turning axis|^2
    expected = 2.0 * SIGMA**2 + bias**2 * (across + time_s**2)
    np.testing.assert_allclose(np.radians(found) ** 2, expected, rtol=1e-6)


def test_two_samples_at_one_time_are_refused() -> None:
    sun, information, motion = at_rest(3, Gyro())
    with pytest.raises(ValueError, match="time_s"):
        recursive_bound(sun, information, Motion(motion.turn, np.array([0.0, 1, 1]), motion.gyro))
