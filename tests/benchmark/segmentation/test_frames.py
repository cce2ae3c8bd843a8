"""Frames under faults: what their light says of their truth; networks as they are kept."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark import datasets
from benchmark.segmentation.frames import DIM, FaultyUnit
from benchmark.segmentation.methods import BOARDS
from benchmark.segmentation.training import LEARNED
from benchmark.segmentation.unet import trained


@pytest.mark.slow  # diffraction is tabulated
def test_the_suns_own_pixels_hold_its_light_and_there_are_none_without_it() -> None:
    unit = FaultyUnit(datasets.get("cmos-single-aperture").for_unit(LEARNED.start))
    clean = unit.drawn("clean", 20)
    under = np.where(clean.truth, clean.frames, 0.0).sum(axis=(1, 2))
    whole = (clean.frames - np.median(clean.frames)).sum(axis=(1, 2))
    assert (under / whole).min() > 0.7
    assert np.array_equal(unit.drawn("clean", 20).frames, clean.frames)
    dark, two = unit.drawn("no-sun", 20), unit.drawn("two-suns", 20)
    assert not dark.truth.any()
    assert not dark.light.any()
    assert 1.3 < two.truth.sum() / clean.truth.sum() < 2.1
    light = unit.drawn("dim", 20).light
    assert (0.8 * DIM[0] < light).all()
    assert (light < 1.2 * DIM[1]).all()


@pytest.mark.parametrize("board", BOARDS)
def test_networks_are_small_and_learned_from_no_unit_that_is_scored(board) -> None:
    network = trained(board)
    assert network.parameters <= 30_000
    assert network.card["units"] == [LEARNED.start, LEARNED.stop - 1]
    assert LEARNED.start > 9
