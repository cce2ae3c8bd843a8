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
