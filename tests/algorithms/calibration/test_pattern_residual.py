"""Residuals of patterns: their distribution on drawn noise, and what two lights leave."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import chi2

from algorithms.calibration.pattern_residual import PatternResidual, tail_threshold
from algorithms.contract import NotFittedError, UnusableDataError

RNG = np.random.default_rng(11)
#: Five faces, a pyramid with a flat top: all see the Sun within 30 deg.
FACES = np.array([[0, 0, 2**0.5], [1, 0, 1], [-1, 0, 1], [0, 1, 1], [0, -1, 1]]) / math.sqrt(2.0)
SPREAD = 1e-3


@pytest.fixture(autouse=True)
def _the_same_draws_whatever_ran_before() -> None:
    RNG.bit_generator.state = np.random.default_rng(11).bit_generator.state


def suns(count: int, widest_deg: float = 28.0) -> np.ndarray:
    tangents = np.tan(np.deg2rad(RNG.uniform(-widest_deg, widest_deg, (count, 2))))
    ahead = np.column_stack([tangents, np.ones(count)])
    return ahead / np.linalg.norm(ahead, axis=1, keepdims=True)


def currents(light: np.ndarray) -> np.ndarray:
    """Cosine response of every face, with noise of `SPREAD`."""
    return np.maximum(light @ FACES.T, 0.0) + SPREAD * RNG.normal(size=(len(light), len(FACES)))


@pytest.fixture(scope="module")
def faces() -> PatternResidual:
    sun = suns(400, 34.0)
    return PatternResidual().fit(currents(sun), sun)


@pytest.mark.parametrize("rate", [0.2, 0.02])
def test_on_drawn_noise_the_residual_alarms_as_often_as_chi_square_says(faces, rate) -> None:
    """Five currents, less direction and brightness: two degrees of freedom."""
    sun = suns(1500)
    found = faces.measure(currents(sun), sun)
    alarms = np.mean(2.0 * found.pattern > chi2.isf(rate, 2))
    assert alarms == pytest.approx(rate, rel=0.35)
    assert np.median(found.brightness) == pytest.approx(1.0, abs=0.01)


def test_two_lights_on_the_same_cosine_faces_are_one_and_no_residual_tells(faces) -> None:
    """Currents add as vectors do while every face sees both lights."""
    both = 0.5 * (suns(500) + suns(500))
    answer = both / np.linalg.norm(both, axis=1, keepdims=True)
    found = faces.measure(currents(both), answer)
    assert np.median(found.pattern) < 2.0
    # only brightness does
    assert found.brightness == pytest.approx(np.linalg.norm(both, axis=1), abs=0.02)


def test_two_lights_of_which_a_face_sees_one_leave_a_residual(faces) -> None:
    sun = suns(300)
    low = np.tile([[0.3, 0.0, 0.1]], (300, 1))
    both = np.maximum(sun @ FACES.T, 0.0) + np.maximum(low @ FACES.T, 0.0)
    answer = sun + low
    answer /= np.linalg.norm(answer, axis=1, keepdims=True)
    assert np.mean(faces.measure(both, answer).pattern > chi2.isf(1e-4, 2) / 2.0) > 0.99


FOCAL_PX, SIZE = 60.0, 33


def spots(light: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """Images of a round spot where a pinhole puts it, in windows, in noise of one unit."""
    centre = FOCAL_PX * light[:, :2] / light[:, 2:] - origin
    y, x = np.mgrid[:SIZE, :SIZE]
    apart = (x - centre[:, :1, None]) ** 2 + (y - centre[:, 1:, None]) ** 2
    return 200.0 * np.exp(-apart / (2.0 * 2.0**2)) + RNG.normal(size=apart.shape)


def windows(light: np.ndarray) -> np.ndarray:
    spot = np.rint(FOCAL_PX * light[:, :2] / light[:, 2:])
    return spot - SIZE // 2 + RNG.integers(-3, 4, spot.shape)


def test_an_image_is_predicted_where_the_answer_puts_it_and_a_second_spot_is_not() -> None:
    sun = suns(100, 32.0)
    origin = windows(sun)
    test = PatternResidual(FOCAL_PX).fit(spots(sun, origin), sun, origin)
    sun = suns(40, 25.0)
    origin = windows(sun)
    clean = spots(sun, origin)
    found = test.measure(clean, sun, origin)
    assert found.pattern == pytest.approx(np.ones(40), abs=0.5)
    assert found.brightness == pytest.approx(np.ones(40), abs=0.02)
    second = 0.2 * np.roll(clean - np.median(clean), 9, axis=2)
    assert (test.measure(clean + second, sun, origin).pattern > 2.0).all()
    nothing = test.measure(clean[:1], np.full((1, 3), np.nan), origin[:1])
    assert np.isnan(nothing.pattern).all()


@pytest.mark.parametrize("rate", [1e-3, 1e-4])
def test_the_tail_of_an_exponential_is_its_logarithm(rate) -> None:
    drawn = RNG.exponential(size=(40, 2000))
    found = [tail_threshold(one, rate) for one in drawn]
    assert np.median(found) == pytest.approx(-math.log(rate), rel=0.05)


def test_a_tail_that_ends_is_not_extrapolated_beyond_its_end() -> None:
    assert tail_threshold(RNG.random(20_000), 1e-6) == pytest.approx(1.0, abs=2e-3)
    assert tail_threshold(np.arange(1000.0), 0.1) == pytest.approx(899.1)


def test_wrong_input_is_refused() -> None:
    sun = suns(20)
    with pytest.raises(ValueError, match="dimensions and as many directions"):
        PatternResidual().fit(currents(sun), sun[:5])
    with pytest.raises(UnusableDataError, match="more than 12 readings; got 5"):
        PatternResidual().fit(currents(sun[:5]), sun[:5])
    with pytest.raises(NotFittedError, match="call fit first"):
        PatternResidual().measure(currents(sun), sun)
    with pytest.raises(ValueError, match="as those of the calibration"):
        PatternResidual().fit(currents(sun), sun).measure(np.ones((1, 3)), sun[:1])
    with pytest.raises(ValueError, match="10 statistics at least; got 5 of 100"):
        tail_threshold(np.arange(100.0), 1e-3)
    with pytest.raises(ValueError, match="probabilities"):
        tail_threshold(np.arange(100.0), 0.0)
