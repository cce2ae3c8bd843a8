"""Dark subtraction, flat division and bad pixels against the readings they were made from."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.references import ReferenceCorrection


def unit(shape, seed=0):
    """Relative gains and dark signals of a detector."""
    rng = np.random.default_rng(seed)
    return rng.normal(1.0, 0.02, shape), rng.uniform(5.0, 15.0, shape)


@settings(deadline=None, derandomize=True)
@given(seed=st.integers(0, 1000), shape=st.sampled_from([(6,), (64,), (9, 7)]))
def test_light_is_recovered_whatever_gains_and_darks_but_for_one_factor(seed, shape):
    gain, dark = unit(shape, seed)
    light = np.random.default_rng(seed + 1).uniform(0.0, 900.0, (5, *shape))
    found = ReferenceCorrection(dark, gain * 500.0 + dark).correct(gain * light + dark)
    np.testing.assert_allclose(found, light * gain.mean(), rtol=1e-9, atol=1e-9)


def test_windows_are_corrected_as_the_part_of_the_detector_that_they_show():
    gain, dark = unit((40, 50))
    frames = np.random.default_rng(2).uniform(0, 1000, (3, 40, 50)).astype(np.uint16)
    correction = ReferenceCorrection(dark, 500 * gain + dark, 1023.0, pixels=True)
    whole = correction.correct(frames)
    origin = np.array([[0, 0], [38, 25], [11, 3]])
    windows = np.stack(
        [f[y : y + 15, x : x + 12] for f, (x, y) in zip(frames, origin, strict=True)]
    )
    expected = [f[y : y + 15, x : x + 12] for f, (x, y) in zip(whole, origin, strict=True)]
    np.testing.assert_array_equal(correction.correct(windows, origin), expected)


def test_dead_and_hot_pixels_take_the_mean_of_the_good_ones_beside_them():
    dark, flat = np.full((5, 6), 10.0), np.full((5, 6), 510.0)
    flat[2, 2] = 20.0  # dead
    dark[2, 3] += 200.0  # hot
    flat[2, 3] += 200.0
    correction = ReferenceCorrection(dark, flat, pixels=True)
    assert np.argwhere(correction.bad).tolist() == [[2, 2], [2, 3]]
    y, x = np.mgrid[:5, :6]
    frame = 10.0 + 3.0 * x + 7.0 * y
    frame[2, 2:4] = 12345.0
    found = correction.correct(frame[None])[0]
    around = [(1, 1), (1, 2), (1, 3), (2, 1), (3, 1), (3, 2), (3, 3)]
    assert found[2, 2] == pytest.approx(np.mean([3.0 * c + 7.0 * r for r, c in around]))
    good = ~correction.bad
    np.testing.assert_allclose(found[good], (3.0 * x + 7.0 * y)[good])


def test_a_bad_pixel_of_a_profile_on_a_straight_slope_is_on_it():
    dark, flat = np.zeros(50), np.full(50, 100.0)
    flat[20] = 1.0
    profile = 2.0 * np.arange(50.0)
    found = ReferenceCorrection(dark, flat, pixels=True).correct(profile[None])[0]
    np.testing.assert_allclose(found, profile)


def test_saturated_readings_stay_one_plateau_above_all_others():
    gain, dark = unit((8, 8))
    correction = ReferenceCorrection(dark, 300 * gain + dark, 1023.0, pixels=True)
    frame = np.full((1, 8, 8), 400, dtype=np.uint16)
    frame[0, 3, 2:6] = 1023
    found = correction.correct(frame)[0]
    assert len(set(found[3, 2:6])) == 1
    assert found[3, 2] > np.delete(found.ravel(), np.arange(26, 30)).max()


@pytest.mark.parametrize(
    ("dark", "flat", "message"),
    [
        (np.zeros(3), np.ones(4), "one detector"),
        (np.zeros((2, 2, 2)), np.ones((2, 2, 2)), "one or two dimensions"),
        (np.zeros(3), np.array([1.0, np.nan, 1.0]), "finite"),
        (np.ones(3), np.zeros(3), "brighter"),
    ],
)
def test_references_that_are_none_are_refused(dark, flat, message):
    with pytest.raises(ValueError, match=message):
        ReferenceCorrection(dark, flat)


@pytest.mark.parametrize(
    ("shape", "origin", "message"),
    [
        ((2, 9, 9), None, "observations must have shape"),
        ((2, 9), None, "observations must have shape"),
        ((2, 4, 4), [[0, 0]], "origin_px must have shape"),
        ((1, 4, 4), [[7, 0]], "reaches beyond"),
        ((1, 4, 4), [[0, -1]], "reaches beyond"),
    ],
)
def test_observations_of_another_detector_are_refused(shape, origin, message):
    correction = ReferenceCorrection(np.zeros((8, 10)), np.ones((8, 10)))
    with pytest.raises(ValueError, match=message):
        correction.correct(np.zeros(shape), origin)
