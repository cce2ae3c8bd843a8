"""Frames under a fault of a chosen strength, against the plain frames of the same unit."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark import datasets
from benchmark.learned_faults.frames import FaultyUnit
from benchmark.learned_faults.rule import DATASET, FAULTS


@pytest.fixture(scope="module")
def unit() -> FaultyUnit:
    return FaultyUnit(datasets.get(DATASET).for_unit(60))


def median(frames: np.ndarray) -> np.ndarray:
    return np.median(frames, axis=(1, 2))


@pytest.mark.slow  # diffraction is tabulated
def test_at_strength_zero_every_fault_leaves_the_plain_frames(unit: FaultyUnit) -> None:
    plain = unit.taken(unit.scene(3, "a test"), "a test")
    for fault in FAULTS:
        struck = unit.struck(fault, 0.0, 3, "a test")
        np.testing.assert_array_equal(struck.corrected.astype(np.float32), plain.corrected)
        np.testing.assert_array_equal(struck.sun, plain.sun)


@pytest.mark.slow  # diffraction is tabulated
def test_stronger_faults_of_the_same_name_are_the_weaker_ones_and_more(unit: FaultyUnit) -> None:
    whole = unit.struck("glare", 0.0, 3, "a test").corrected
    little, much = (unit.struck("glare", s, 3, "a test").corrected - whole for s in (0.1, 0.2))
    # what noise of some 1 % of the light leaves over 65,536 pixels
    np.testing.assert_allclose(much.mean(axis=(1, 2)), 2.0 * little.mean(axis=(1, 2)), rtol=0.01)
    few, many = (unit.struck("hidden holes", s, 3, "a test").corrected for s in (0.3, 0.6))
    lit = [(frames - median(frames)[:, None, None]).sum() for frames in (whole, few, many)]
    assert lit[0] > lit[1] > lit[2] > 0.0
    assert not ((few < whole - 100.0) & (many > whole - 50.0)).any()  # no hole is cleaned again


@pytest.mark.slow  # diffraction is tabulated
def test_a_laser_adds_spots_in_proportion_to_its_light(unit: FaultyUnit) -> None:
    whole = unit.struck("laser", 0.0, 3, "a test").corrected
    dim, bright = (
        (unit.struck("laser", s, 3, "a test").corrected - whole).sum() for s in (0.2, 0.4)
    )
    assert dim > 0.0
    assert bright == pytest.approx(2.0 * dim, rel=0.02)


def test_a_fault_that_there_is_not_is_refused(unit: FaultyUnit) -> None:
    with pytest.raises(ValueError, match="no fault 'rain'"):
        unit.struck("rain", 0.1, 1, "a test")
