"""Pixel arrays of the standard data sets err as detectors do that one can buy, and age."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmark import datasets

AREAS = ["cmos-single-aperture", "ccd-single-aperture", "cmos-slit", "cmos-encoded"]


@pytest.mark.parametrize("name", AREAS)
def test_an_aged_detector_is_darker_in_the_dark_by_what_its_condition_says(name: str) -> None:
    """The same unit: pixels' own shares of the dark current stay, one in a hundred is hot."""
    data = datasets.get(name)
    new, old = (data.fixed_pattern(condition)["dark_e"] for condition in ("nominal", "aged"))
    some = new > 0
    growth = old[some] / new[some]
    assert growth.min() == pytest.approx(20.0)
    hot = growth > 20.0 * (1 + 1e-9)
    count = growth.size
    assert hot.mean() == pytest.approx(0.01, abs=4 * math.sqrt(0.01 / count))
    # an exponential's mean, of n values within 4 / sqrt(n) of it
    mean = np.mean(growth[hot] / 20.0 - 1.0)
    assert mean == pytest.approx(20.0, rel=4 / math.sqrt(0.01 * count))
    assert "20 times" in data.setups["aged"].description
