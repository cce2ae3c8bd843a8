"""Repeatability, the spread of answers to a pose held still: brute force and known noise."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmark.metrics.score import repeatability_deg


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def poses_of(rng, count):
    return unit(rng.standard_normal((count, 3)) + np.array([0.0, 0.0, 4.0]))


def scattered(rng, poses, passes, sigma_deg):
    """Answers (R, P, 3): poses off by independent normal angles along two tangent axes."""
    first = unit(np.cross(poses, [1.0, 0.0, 0.0]))
    second = np.cross(poses, first)
    a, b = np.deg2rad(sigma_deg) * rng.standard_normal((2, passes, len(poses), 1))
    return unit(poses + a * first + b * second)


def by_brute_force(answers):
    """Pose by pose: project on the plane across the mean, take NumPy's variances, pool them."""
    total, freedom = 0.0, 0
    for pose in np.swapaxes(answers, 0, 1):
        found = pose[np.isfinite(pose).all(axis=1)]
        if len(found) < 2:
            continue
        middle = unit(found.mean(axis=0))
        first = unit(np.cross(middle, [0.0, 1.0, 0.0]))
        axes = np.column_stack([first, np.cross(middle, first)])
        x, y = (found @ axes).T
        total += (len(found) - 1) * (np.var(x, ddof=1) + np.var(y, ddof=1))
        freedom += len(found) - 1
    return np.rad2deg(np.sqrt(total / freedom)) if freedom else np.nan


@settings(deadline=None, derandomize=True, max_examples=60)
@given(
    seed=st.integers(0, 2**32 - 1),
    passes=st.integers(1, 8),
    count=st.integers(1, 12),
    sigma=st.floats(1e-6, 0.2),
    missing=st.floats(0.0, 1.0),
)
def test_it_is_the_pooled_standard_deviation_about_the_mean_of_each_pose(
    seed, passes, count, sigma, missing
):
    rng = np.random.default_rng(seed)
    answers = scattered(rng, poses_of(rng, count), passes, sigma)
    answers[rng.random((passes, count)) < missing] = np.nan
    expected = by_brute_force(answers)
    assert repeatability_deg(answers) == pytest.approx(expected, rel=1e-4, nan_ok=True)


@pytest.mark.parametrize("passes", [2, 8])
def test_known_noise_gives_the_root_of_the_sum_of_its_two_variances(passes):
    """Without the division by one less than the passes, two of them would give 0.7 of it."""
    rng = np.random.default_rng(5)
    answers = scattered(rng, poses_of(rng, 20000 // passes), passes, 0.1)
    assert repeatability_deg(answers) == pytest.approx(0.1 * np.sqrt(2), rel=0.02)


def test_errors_that_stay_the_same_do_not_enter():
    """The spread is about the answers' own mean: a bias by 3 degrees changes nothing."""
    rng = np.random.default_rng(6)
    poses = poses_of(rng, 40)
    moved = unit(poses + np.tan(np.deg2rad(3.0)) * unit(np.cross(poses, [0.0, 1.0, 0.0])))
    spreads = [
        repeatability_deg(scattered(np.random.default_rng(7), where, 8, 0.05))
        for where in (poses, moved)
    ]
    assert spreads[0] == pytest.approx(spreads[1], rel=1e-3)


def test_one_answer_a_pose_says_nothing():
    answers = np.full((4, 3, 3), np.nan)
    answers[0] = [0.0, 0.0, 1.0]
    assert np.isnan(repeatability_deg(answers))
    assert np.isnan(repeatability_deg(np.empty((4, 0, 3))))


@pytest.mark.parametrize(
    ("answers", "message"),
    [
        (np.ones((4, 3)), r"repeated.*\(R.*3\).*\(4.*3\)"),
        (np.ones((2, 2, 3)), "unit vectors"),
        ([[[0.0, 0.0, np.nan]]], "finite in some columns only"),
    ],
)
def test_what_are_no_answers_is_refused(answers, message):
    with pytest.raises(ValueError, match=message):
        repeatability_deg(answers)
