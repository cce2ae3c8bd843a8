"""Metrics against closed forms, brute force and simulated estimators of known quality."""

from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from benchmark.metrics.score import METRICS, is_available, score, stored_beside
from benchmark.metrics.separation import separation_deg, store

ANGLES = st.floats(1e-9, 179.0)
NAN = float("nan")
STATISTICS = ("rms_deg", "median_deg", "p95_deg", "p997_deg", "max_deg")


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


SAMPLES = st.lists(
    st.tuples(st.booleans(), st.booleans(), st.floats(1e-6, 170.0), st.floats(0.0, 6.28)),
    min_size=1,
    max_size=60,
)


@settings(deadline=None, derandomize=True)
@given(samples=SAMPLES)
def test_errors_are_of_answers_to_observable_samples_and_shares_count_the_rest(samples):
    """Whatever is answered, observable or not: NumPy over the samples picked one by one."""
    seen = np.array([one for one, *_ in samples])
    answered = np.array([two for _, two, *_ in samples])
    angles = np.array([angle for *_, angle, _ in samples])
    axes = np.array([[np.cos(around), np.sin(around), 0.0] for *_, around in samples])
    sun = np.tile([0.0, 0.0, 1.0], (len(samples), 1))
    predicted = Rotation.from_rotvec(np.deg2rad(angles)[:, None] * axes).apply(sun)
    predicted[~answered] = np.nan
    result = score(predicted, sun, None, seen)

    def share(of):
        return pytest.approx(np.mean(of) if of.size else NAN, nan_ok=True)

    assert result.availability == share(answered[seen])
    assert result.false_detection_rate == share(answered[~seen])
    judged = angles[seen & answered]
    expected = {
        "rms_deg": np.sqrt(np.mean(judged**2)),
        "median_deg": np.median(judged),
        "p95_deg": np.percentile(judged, 95),
        "p997_deg": np.percentile(judged, 99.7),
        "max_deg": judged.max(),
    } if judged.size else dict.fromkeys(STATISTICS, NAN)  # fmt: skip
    for name, value in expected.items():
        assert getattr(result, name) == pytest.approx(value, rel=1e-6, nan_ok=True), name


def test_an_answer_to_an_unobservable_sample_is_charged_and_moves_no_other_error():
    rng = np.random.default_rng(1)
    sun = cone(rng, 200)
    predicted = tangent_noise(rng, sun, 0.3)
    seen = np.arange(200) % 4 != 0
    bounds = {"bound_deg": np.full(200, 0.4), "bound_unit_deg": np.full(200, 0.5)}
    plain = score(predicted, sun, observable=seen, **bounds)
    predicted[~seen] = -sun[~seen]
    wrong = score(predicted, sun, observable=seen, **bounds)
    charged = replace(plain, rms_all_answers_deg=wrong.rms_all_answers_deg)
    np.testing.assert_equal(asdict(wrong), asdict(charged))  # NaN is NaN
    everything = np.concatenate([separation_deg(predicted, sun)[seen], np.full(50, 180.0)])
    assert wrong.rms_all_answers_deg == pytest.approx(np.sqrt(np.mean(everything**2)))
    predicted[~seen] = np.nan
    silent = score(predicted, sun, observable=seen, **bounds)
    assert (plain.false_detection_rate, silent.false_detection_rate) == (1.0, 0.0)
    free = replace(plain, false_detection_rate=0.0, rms_all_answers_deg=plain.rms_deg)
    np.testing.assert_equal(asdict(silent), asdict(free))


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
    assert (result.availability, result.false_detection_rate) == (pytest.approx(2 / 3), 1.0)


def test_a_misalignment_is_all_that_alignment_takes_away():
    rng = np.random.default_rng(3)
    sun = cone(rng, 300)
    noisy = tangent_noise(rng, sun, 0.05)
    turned = rotated(noisy, [1.0, -2.0, 0.5], 0.7)
    plain, off = (score(p, sun, None, np.ones(300, bool)) for p in (noisy, turned))
    assert off.rms_deg > 0.4
    assert off.aligned_deg == pytest.approx(plain.aligned_deg, rel=1e-6)
    best, _ = Rotation.align_vectors(sun, turned)
    left = separation_deg(best.apply(turned), sun)
    assert off.aligned_deg == pytest.approx(np.sqrt(np.mean(left**2)), rel=1e-9)


def test_without_a_bound_the_errors_stand_and_nothing_is_compared():
    sun = np.array([[0.0, 0.0, 1.0]] * 4)
    row = score(rotated(sun, [1, 0, 0], 3.0), sun, None, np.ones(4, bool)).row()
    assert row["rms_deg"] == 3.0
    assert [row[name] for name in ("bound_deg", "over_bound", "over_bound_se")] == [None] * 3


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


def test_nothing_answered_is_undefined_and_never_a_number():
    sun = np.array([[0.0, 0.0, 1.0]] * 3)
    row = score(np.full((3, 3), np.nan), sun, np.ones(3), np.array([True, True, False])).row()
    assert tuple(row) == METRICS
    assert {name: value for name, value in row.items() if value is not None} == {
        "availability": 0.0,
        "false_detection_rate": 0.0,
    }


def test_nothing_observable_leaves_only_false_suns():
    sun = np.array([[0.0, 0.0, 1.0]] * 4)
    predicted = sun.copy()
    predicted[0] = np.nan
    row = score(predicted, sun, np.full(4, np.inf), np.zeros(4, bool)).row()
    assert {name: value for name, value in row.items() if value is not None} == {
        "false_detection_rate": 0.75,
        "rms_all_answers_deg": 0.0,
    }
    assert not is_available(row)


@pytest.mark.parametrize(
    ("share", "enough"), [(1.0, True), (0.95, True), (0.9499, False), (None, False)]
)
def test_a_pipeline_is_available_from_95_percent_on(share, enough):
    assert is_available({"availability": share}) is enough


def from_angles(alpha_deg, beta_deg):
    tangents = np.tan(np.deg2rad([beta_deg, alpha_deg]))
    vectors = np.column_stack([*tangents, np.ones(len(alpha_deg))])
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def test_axis_errors_are_predicted_less_true_of_each_angle_by_itself():
    alpha, beta = np.array([10.0, -20.0, 35.0]), np.array([5.0, 40.0, -15.0])
    by_alpha, by_beta = np.array([0.3, -0.1, 0.4]), np.array([-0.2, -0.5, 0.1])
    sun = np.vstack([from_angles(alpha, beta), [[0.0, 0.6, 0.8]], [[0.0, 0.6, -0.8]]])
    predicted = np.vstack([from_angles(alpha + by_alpha, beta + by_beta), sun[[4]], sun[[3]]])
    result = score(predicted, sun, None, np.ones(5, bool))
    # of the last two, one is seen behind the detector and one is there
    assert result.bias_alpha_deg == pytest.approx(0.2)
    assert result.bias_beta_deg == pytest.approx(-0.2)
    assert result.rms_alpha_deg == pytest.approx(np.sqrt(np.mean(by_alpha**2)))
    assert result.rms_beta_deg == pytest.approx(np.sqrt(np.mean(by_beta**2)))
    assert result.max_deg == pytest.approx(2 * np.rad2deg(np.arcsin(0.8)))


@pytest.mark.parametrize(
    ("errors", "bounds", "ratio", "se"),
    [
        # residuals e^2 - 2.5 of 1 and 2 degrees: +-1.5; 3 over the bounds' 2, over twice the ratio
        ([1.0, 2.0], [1.0, 1.0], np.sqrt(2.5), 1.5 / (2 * np.sqrt(2.5))),
        ([1.0, 2.0], [1.0, 2.0], 1.0, 0.0),
        ([2.0, 1.0], [1.0, 2.0], 1.0, np.sqrt(2 * 18.0) / 5 / 2),
        ([3.0], [2.0], 1.5, None),  # one error has no spread
        ([0.0, 0.0], [1.0, 1.0], 0.0, None),
        ([1.0, 2.0], [1.0, np.inf], None, None),
        ([1.0, 2.0], [0.0, 0.0], None, None),
    ],
)
def test_the_ratio_to_the_bound_and_its_standard_error_in_closed_form(errors, bounds, ratio, se):
    sun = np.array([[0.0, 0.0, 1.0]] * len(errors))
    turns = np.deg2rad(errors)
    predicted = np.column_stack([np.sin(turns), np.zeros_like(turns), np.cos(turns)])
    row = score(predicted, sun, bounds, np.ones(len(errors), bool)).row()

    def rounded(value):
        return None if value is None else pytest.approx(value, rel=1e-4, abs=1e-9)

    assert row["over_bound"] == rounded(ratio)
    assert row["over_bound_se"] == rounded(se)


@pytest.mark.parametrize(("off", "unit"), [(0.9e-6, True), (-0.9e-6, True), (1.1e-6, False)])
def test_a_prediction_s_length_is_one_within_a_millionth(off, unit):
    sun = np.array([[0.0, 0.6, 0.8]] * 2)
    predicted = sun * [[1.0], [1.0 + off]]
    if unit:
        assert score(predicted, sun, None, np.ones(2, bool)).availability == 1.0
    else:
        with pytest.raises(ValueError, match="one has length"):
            score(predicted, sun, None, np.ones(2, bool))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"sun": np.ones(3)}, "sun must have shape"),
        ({"sun": np.ones((0, 3)), "predicted": np.ones((0, 3))}, "sun must have shape"),
        ({"observable": np.ones(3, bool)}, "bound_deg and observable"),
        ({"bound_deg": np.ones(3)}, "bound_deg and observable"),
        ({"predicted": np.ones((2, 2))}, r"predicted must have shape \(N, 3\)"),
        ({"predicted": np.ones((1, 3))}, r"predicted must have shape \(2, 3\)"),
        ({"predicted": [[0, 0, 1], [0, np.nan, 1]]}, "row 1"),
        ({"predicted": [[0, 0, 1], [0, 0, 1.1]]}, "unit vectors; one has length 1.1"),
        ({"repeated": np.ones((2, 3))}, "repeated must have shape"),
        ({"repeated": np.ones((2, 3, 2))}, "repeated must have shape"),
    ],
)
def test_what_cannot_be_scored_is_named(changed, message):
    sun = np.array([[0.0, 0.0, 1.0]] * 2)
    given = {"predicted": sun, "sun": sun, "bound_deg": None, "observable": np.ones(2, bool)}
    with pytest.raises(ValueError, match=message):
        score(**{**given, **changed})


def test_numbers_are_stored_with_five_significant_digits_and_rings_with_four():
    assert store(0.000123456789) == 0.00012346
    assert store(123456789.0) == 123460000.0
    assert store(float("inf")) is None
    sun = np.array([[0.0, 0.0, 1.0]] * 5)
    row = score(rotated(sun, [1, 0, 0], 1.23456789), sun, None, np.ones(5, bool)).row()
    assert (row["rms_deg"], row["rms_0_10_deg"]) == (1.2346, 1.235)


def test_a_bias_is_stored_to_the_last_digit_of_its_rms():
    """Errors of +1.2345678 and -1.2 degrees: their mean, 0.0172839, has no digit of its own."""
    turns = np.deg2rad([1.2345678, -1.2])
    sun = np.array([[0.0, 0.0, 1.0]] * 2)
    off = np.column_stack([np.zeros(2), np.sin(turns), np.cos(turns)])
    row = score(off, sun, None, np.ones(2, bool)).row()
    assert (row["rms_alpha_deg"], row["bias_alpha_deg"]) == (1.2174, 0.0173)
    assert (row["rms_beta_deg"], row["bias_beta_deg"]) == (0.0, 0.0)


@pytest.mark.parametrize("tiny", [1e-9, -1e-9])
def test_a_bias_that_rounds_to_nothing_has_no_sign(tiny):
    assert str(stored_beside(tiny, 1.0)) == "0.0"
