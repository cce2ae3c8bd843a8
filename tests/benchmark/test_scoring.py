"""Metrics against closed forms, brute force and simulated estimators of known quality."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from benchmark.scoring import METRICS, score, separation_deg, stored

ANGLES = st.floats(1e-9, 179.0)


def rotated(sun, axis, angle_deg):
    axis = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    return Rotation.from_rotvec(np.deg2rad(angle_deg) * axis).apply(sun)


def tangent_noise(rng, sun, sigma_deg):
    """Directions off by independent normal angles along two tangent axes."""
    first = np.cross(sun, [1.0, 0.0, 0.0])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(sun, first)
    a, b = np.tan(np.deg2rad(sigma_deg * rng.standard_normal((2, len(sun), 1))))
    moved = sun + a * first + b * second
    return moved / np.linalg.norm(moved, axis=1, keepdims=True)


def cone(rng, n, half_deg=30.0):
    off = np.deg2rad(half_deg) * np.sqrt(rng.random(n))
    around = 2 * np.pi * rng.random(n)
    return np.stack([np.sin(off) * np.cos(around), np.sin(off) * np.sin(around), np.cos(off)], 1)


@settings(deadline=None, derandomize=True)
@given(angle=ANGLES, around=st.floats(0.0, 6.28))
def test_the_separation_is_the_angle_of_the_rotation_between_down_to_nanodegrees(angle, around):
    sun = np.array([[0.0, 0.0, 1.0]])
    found = separation_deg(rotated(sun, [np.cos(around), np.sin(around), 0.0], angle), sun)
    assert found[0] == pytest.approx(angle, rel=1e-6)


def test_a_constant_rotation_about_y_is_a_bias_in_beta_alone():
    """tan(beta) = s_x / s_z: turning the boresight by 2 degrees about y adds 2 degrees to beta."""
    sun = np.array([[0.0, 0.0, 1.0]] * 5)
    result = score(rotated(sun, [0, 1, 0], 2.0), sun, np.ones(5), np.ones(5, bool))
    assert result.bias_beta_deg == pytest.approx(2.0)
    assert result.bias_alpha_deg == pytest.approx(0.0, abs=1e-12)
    for name in ("rms_deg", "median_deg", "p95_deg", "max_deg", "rms_beta_deg", "over_bound"):
        assert getattr(result, name) == pytest.approx(2.0), name


def test_statistics_agree_with_brute_force_over_the_found_samples():
    rng = np.random.default_rng(1)
    sun = cone(rng, 200)
    predicted = tangent_noise(rng, sun, 0.3)
    predicted[::5] = np.nan
    result = score(predicted, sun, np.full(200, 0.4), np.ones(200, bool))
    errors = [
        np.rad2deg(np.arccos(np.clip(p @ s, -1, 1)))
        for p, s in zip(predicted, sun, strict=True)
        if np.isfinite(p).all()
    ]
    assert result.found_fraction == 0.8
    assert result.rms_deg == pytest.approx(np.sqrt(np.mean(np.square(errors))), rel=1e-6)
    assert result.median_deg == pytest.approx(np.median(errors), rel=1e-6)
    assert result.p95_deg == pytest.approx(np.percentile(errors, 95), rel=1e-6)
    assert result.max_deg == pytest.approx(max(errors), rel=1e-6)


def test_axis_errors_leave_out_directions_behind_the_detector():
    sun = np.array([[0.0, 0.0, 1.0], [0.0, 0.6, -0.8]])
    result = score(sun, sun, np.ones(2), np.ones(2, bool))
    assert result.rms_alpha_deg == result.bias_beta_deg == 0.0
    behind = score(sun[1:], sun[1:], np.ones(1), np.ones(1, bool))
    assert np.isnan(behind.rms_alpha_deg)
    assert behind.rms_deg == 0.0


def test_the_bound_is_taken_over_samples_both_found_and_observable():
    sun = np.array([[0.0, 0.0, 1.0]] * 4)
    predicted = rotated(sun, [1, 0, 0], 3.0)
    predicted[0] = np.nan
    bound = np.array([100.0, 1.0, 2.0, np.inf])
    result = score(predicted, sun, bound, np.array([True, True, True, False]))
    assert result.bound_deg == pytest.approx(np.sqrt((1 + 4) / 2))
    assert result.over_bound == pytest.approx(3 / np.sqrt(2.5))
    assert result.observable_fraction == 0.75


def test_an_efficient_estimator_scores_one_and_the_standard_error_covers_it():
    """Errors drawn with exactly the bound's covariance: z-scores of over_bound are standard."""
    rng = np.random.default_rng(2)
    z = []
    for _ in range(300):
        sun = cone(rng, 200)
        sigma = 0.01 * (1 + rng.random((200, 1)))
        predicted = tangent_noise(rng, sun, sigma)
        result = score(predicted, sun, np.sqrt(2) * sigma[:, 0], np.ones(200, bool))
        z.append((result.over_bound - 1) / result.over_bound_se)
    assert abs(np.mean(z)) < 4 / np.sqrt(300) + 0.1  # the ratio's own small-sample bias is < 0.1
    assert 0.85 < np.std(z) < 1.15


def test_a_leak_of_the_truth_falls_below_the_bound_by_many_standard_errors():
    rng = np.random.default_rng(3)
    sun = cone(rng, 400)
    leaked = tangent_noise(rng, sun, 0.5)
    result = score(leaked, sun, np.full(400, np.sqrt(2)), np.ones(400, bool))
    assert result.over_bound == pytest.approx(0.5, rel=0.1)
    assert result.over_bound + 5 * result.over_bound_se < 1


def test_nothing_found_is_undefined_and_never_a_number():
    sun = np.array([[0.0, 0.0, 1.0]] * 3)
    row = score(np.full((3, 3), np.nan), sun, np.ones(3), np.ones(3, bool)).row()
    assert set(row) == set(METRICS)
    assert row["found_fraction"] == 0.0
    assert row["observable_fraction"] == 1.0
    assert [name for name, value in row.items() if value is not None] == [
        "found_fraction",
        "observable_fraction",
    ]


def test_a_bound_of_zero_gives_no_ratio():
    sun = np.array([[0.0, 0.0, 1.0]] * 3)
    assert score(sun, sun, np.zeros(3), np.ones(3, bool)).row()["over_bound"] is None


def test_numbers_are_stored_with_six_significant_digits():
    assert stored(0.000123456789) == 0.000123457
    assert stored(123456789.0) == 123457000.0
    assert stored(float("inf")) is None


@pytest.mark.parametrize(
    ("predicted", "message"),
    [
        (np.ones((2, 2)), r"predicted must have shape \(N, 3\)"),
        (np.ones((1, 3)), r"predicted must have shape \(2, 3\)"),
        ([[0, 0, 1], [0, np.nan, 1]], "row 1 is finite in some columns only"),
        ([[0, 0, 1], [0, 0, 1.1]], "unit vectors; one has length 1.1"),
    ],
)
def test_wrong_predictions_are_refused(predicted, message):
    sun = np.array([[0.0, 0.0, 1.0]] * 2)
    with pytest.raises(ValueError, match=message):
        score(predicted, sun, np.ones(2), np.ones(2, bool))
    with pytest.raises(ValueError, match="bound_deg and observable"):
        score(sun, sun, np.ones(3), np.ones(2, bool))
