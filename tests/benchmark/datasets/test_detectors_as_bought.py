"""Pixel arrays of the standard data sets err as detectors do that one can buy, and age."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.conditions.pixel_arrays import as_bought
from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.readout.pixel_errors import PixelErrors

AREAS = ["cmos-single-aperture", "ccd-single-aperture", "cmos-slit", "cmos-encoded"]


def detector_of(name: str, condition: str = "nominal") -> Any:
    sensor: Any = datasets.get(name).setups[condition].sensor
    return getattr(sensor, "camera", sensor).detector if "lens" in name else sensor.detector


@pytest.mark.parametrize(
    "name", [*AREAS, "ccd-n-slit", "cmos-n-slit", "pda-slit", "ccd-lens", "cmos-lens"]
)
def test_pixels_of_standard_sets_are_not_ideal(name: str) -> None:
    detector = detector_of(name)
    assert isinstance(detector, PixelArray)
    assert detector.errors.crosstalk > 0
    text = datasets.get(name).setups["nominal"].description
    assert "crosstalk" in text
    if "lens" not in name:
        assert as_bought(detector) in text
        assert 0 < detector.errors.nonlinearity <= 0.01


def test_an_ideal_detector_has_nothing_to_say() -> None:
    assert not PixelErrors().of_amplifiers
    assert not PixelErrors().moves_charge
    cmos = as_bought(detector_of("cmos-slit"))
    for said in ("2 % crosstalk", "1 % nonlinearity", "15 electrons"):
        assert said in cmos
    assert "0.01 % smear" in as_bought(detector_of("ccd-single-aperture"))


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
