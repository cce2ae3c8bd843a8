"""Filters of mirror registration: slopes, the weighting, and the noise in both."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.extractors.frames.mirror import fit_kernel
from algorithms.extractors.frames.mirror import taps as filters


def test_the_filter_of_the_slopes_is_the_tangent():
    """2 sum t_n sin(2 pi k n) = 2 tan(pi k d) / d, up to where soft rims have no light left."""
    k = np.linspace(0.01, 0.3, 30)
    for d in (0.0, 0.2, 0.5):
        taps = sum(fit_kernel.TAPS[q] * d ** (2 * q) for q in range(4))
        response = 2 * np.sin(2 * np.pi * np.outer(k, np.arange(1, 7))) @ taps
        tangent = 2 * np.tan(np.pi * k * d) / d if d else 2 * np.pi * k
        np.testing.assert_allclose(response, tangent, rtol=6e-3)


@pytest.mark.parametrize("power", range(5))
def test_the_sharpest_weighting_is_the_slope_of_polynomials_to_the_fourth_power(power):
    """Along its own axis; along the other one it is a mean: of a parabola, a third more."""
    line = np.arange(-2.0, 3.0) ** power
    taps = np.array([-filters.SLOPE_2, -filters.SLOPE_1, 0.0, filters.SLOPE_1, filters.SLOPE_2])
    assert taps @ line == pytest.approx(1.0 if power == 1 else 0.0, abs=1e-12)
    beside = np.array([filters.BESIDE, filters.MIDDLE, filters.BESIDE])
    mean = {0: 1.0, 1: 0.0, 2: 1.0 / 3.0, 3: 0.0, 4: 1.0 / 3.0}
    assert beside @ line[1:4] == pytest.approx(mean[power], abs=1e-12)


def test_what_the_weighting_and_the_slopes_have_in_common_is_known_at_every_displacement():
    """White noise through both: the mean of their product."""
    rng = np.random.default_rng(49)
    line, taps = rng.normal(size=100_000), np.arange(1, 7)
    for d in (0.0, 0.5):
        t = sum(filters.TAPS[q] * d ** (2 * q) for q in range(4))
        slope = sum(t[n - 1] * (np.roll(line, -n) - np.roll(line, n)) for n in taps)
        sharp = filters.SLOPE_1 * (np.roll(line, -1) - np.roll(line, 1))
        sharp += filters.SLOPE_2 * (np.roll(line, -2) - np.roll(line, 2))
        products = filters.noise_of_levels()[1][0]
        expected = sum(products[q] * d ** (2 * q) for q in range(4))
        assert filters.MIDDLE * np.mean(slope * sharp) == pytest.approx(expected, rel=0.03)


def test_the_noise_of_the_slopes_is_known_at_every_displacement():
    """White noise through the slopes: its variance, and what two neighbours have in common."""
    rng = np.random.default_rng(51)
    line, taps = rng.normal(size=200_000), np.arange(1, 7)
    own, common = filters.noise_of_slopes()
    for d in (0.0, 0.5):
        t = sum(filters.TAPS[q] * d ** (2 * q) for q in range(4))
        slope = sum(t[n - 1] * (np.roll(line, -n) - np.roll(line, n)) for n in taps)
        said = [2.0 * np.polyval(given[::-1], d**2) for given in (own, common)]
        measured = [np.mean(slope**2), np.mean(slope * np.roll(slope, 1))]
        np.testing.assert_allclose(measured, said, atol=0.03)
