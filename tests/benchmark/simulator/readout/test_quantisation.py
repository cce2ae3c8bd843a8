"""What readings in whole codes tell of their mean, against sums, limits and drawn readings."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from bare_pixels import bare
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ndtr
from scipy.stats import norm

from benchmark import datasets
from benchmark.seeds import generator
from benchmark.simulator.readout.quantisation import (
    pixel_variance,
    reading_variance,
)

FAR = (-1e6, 1e6)


def of(mean: float, sigma: float, ends: tuple[float, float] = FAR) -> float:
    return float(reading_variance(np.array([mean]), np.array([sigma]), *ends)[0])


def information(mean: float, sigma: float, ends: tuple[float, float] = FAR) -> float:
    """The sum over codes, of SciPy's normal distribution."""
    low = max(ends[0], math.floor(mean - 12 * sigma) - 1)
    high = min(ends[1], math.ceil(mean + 12 * sigma) + 1)
    if low >= high:
        return 0.0
    edges = (np.arange(low, high) + 0.5 - mean) / sigma
    below, above = np.append(-np.inf, edges), np.append(edges, np.inf)
    # the smaller of the tails keeps its digits
    flip = below > 0
    chance = np.where(flip, ndtr(-below) - ndtr(-above), ndtr(above) - ndtr(below))
    slope = norm.pdf(below) - norm.pdf(above)
    possible = chance > 1e-280
    return float(np.sum(slope[possible] ** 2 / chance[possible]) / sigma**2)


@given(st.floats(-0.5, 0.5), st.floats(math.log(0.02), math.log(30.0)))
def test_far_from_the_ends_it_is_the_sum_over_codes(fraction: float, log_sigma: float) -> None:
    """To 1e-3, wherever a reading tells more than a thousandth of a code would."""
    mean, sigma = 1000.0 + fraction, math.exp(log_sigma)
    exact = information(mean, sigma)
    if exact > 1e-6:
        assert of(mean, sigma) == pytest.approx(1 / exact, rel=1e-3)
    else:
        assert of(mean, sigma) > 9e5


@given(st.floats(-5.0, 7.0), st.floats(math.log(0.05), math.log(40.0)), st.booleans())
def test_at_the_ends_all_beyond_is_one_code(
    reach: float,
    log_sigma: float,
    upper: bool,
) -> None:
    sigma = math.exp(log_sigma)
    mean = 1023.0 - reach * sigma if upper else reach * sigma
    exact = information(mean, sigma, (0.0, 1023.0))
    if exact > 1e-6:
        assert of(mean, sigma, (0.0, 1023.0)) == pytest.approx(1 / exact, rel=3e-3)


@pytest.mark.parametrize("sigma", [0.8, 1.0, 1.5, 3.0, 100.0])
@pytest.mark.parametrize("fraction", [0.0, 0.2, 0.5])
def test_noise_above_a_code_costs_a_twelfth_wherever_the_mean_is(
    sigma: float, fraction: float
) -> None:
    """What is left out is 1e-5 / sigma^6 of it: of the sum itself, not of the code alone."""
    plain = sigma**2 + 1 / 12
    assert of(fraction, sigma) == pytest.approx(plain, rel=1e-12)
    assert 1 / information(fraction, sigma) == pytest.approx(
        plain, rel=max(1.3e-5 / sigma**6, 1e-12)
    )


def test_noise_far_below_a_code_tells_of_the_edge_alone() -> None:
    """On the edge, half of the readings on either side: pi/2 of the variance of the signal."""
    sigma = 0.01
    assert of(7.5, sigma) == pytest.approx(math.pi / 2 * sigma**2, rel=1e-6)
    z = 1.7
    there = norm.pdf(z) ** 2 / (ndtr(z) * ndtr(-z)) / sigma**2
    for mean in (7.5 + z * sigma, 7.5 - z * sigma):
        assert of(mean, sigma) == pytest.approx(1 / there, rel=1e-6)
    assert of(7.0, sigma) == math.inf


@pytest.mark.parametrize(("mean", "sigma"), [(2e3, 1.0), (-400.0, 5.0), (9.0, 0.0), (9.5, 0.0)])
def test_a_reading_that_cannot_change_tells_nothing(mean: float, sigma: float) -> None:
    assert of(mean, sigma, (0.0, 1023.0)) == math.inf


@pytest.mark.parametrize(("mean", "sigma"), [(3.4, 0.15), (3.3, 0.4), (3.9, 1.2), (0.3, 0.9)])
def test_the_slope_of_drawn_readings_likelihood_has_this_variance(
    mean: float, sigma: float
) -> None:
    """Fisher's information is the variance of the score; of n drawn to sqrt((kurtosis-1) / n)."""
    n, ends = 200_000, (0.0, 9.0)
    draws = mean + sigma * generator("test", "score", str(mean)).standard_normal(n)
    codes = np.clip(np.rint(draws), *ends)
    step = 1e-5 * sigma

    def log_chance(mu: float) -> np.ndarray:
        above = np.where(codes == ends[1], np.inf, (codes + 0.5 - mu) / sigma)
        below = np.where(codes == ends[0], -np.inf, (codes - 0.5 - mu) / sigma)
        flip = below > 0
        return np.log(np.where(flip, ndtr(-below) - ndtr(-above), ndtr(above) - ndtr(below)))

    squares = ((log_chance(mean + step) - log_chance(mean - step)) / (2 * step)) ** 2
    error = squares.std() / math.sqrt(n)
    assert squares.mean() == pytest.approx(1 / of(mean, sigma, ends), abs=4 * error)


def test_pixels_end_at_their_full_well_and_the_dark_ones_keep_their_read_noise() -> None:
    detector = datasets.get("cmos-slit").setups["nominal"].sensor.detector  # type: ignore[attr-defined]
    detector = replace(detector, full_well_e=500 * detector.gain_e_per_dn, offset_dn=20.0)
    assert detector.errors.nonlinearity == 0.01
    assert detector.last_code_dn == 515  # a hundredth of 500 short of proportion
    detector = bare(detector)
    assert detector.last_code_dn == 520
    per_dn, read = detector.gain_e_per_dn, detector.read_noise_e
    mean = np.array([20.0, 300.0, 700.0])
    sigma = np.sqrt(np.array([0.0, 280.0, 680.0]) * per_dn + read**2) / per_dn
    found = pixel_variance(detector, mean)
    for place in range(3):
        exact = information(mean[place], sigma[place], (0.0, 520.0))
        assert found[place] == pytest.approx(1 / exact if exact > 1e-9 else math.inf, rel=3e-4)
