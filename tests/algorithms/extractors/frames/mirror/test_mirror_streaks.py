"""Saturated streaks: found where they fade alike to both ends, refused where they do not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.extractors.frames.mirror.registration import register
from algorithms.measurement import QualityFlag

MIDDLE = (32.0, 31.0)


def streak(left: float, right: float) -> NDArray[np.uint16]:
    """Light that fades within so many pixels to either side of a peak, saturated, with noise."""
    y, x = np.mgrid[:64, :64]
    dx, dy = x - MIDDLE[0], np.abs(y - MIDDLE[1])
    light = 1000.0 * np.exp(-np.maximum(dx, 0.0) / right + np.minimum(dx, 0.0) / left - dy / 1.2)
    noise = np.random.default_rng(1).normal(0.0, 5.0, light.shape)
    frame = np.asarray(np.clip(np.rint(50.0 + light + noise), 0, 400), dtype=np.uint16)
    frame.setflags(write=False)
    return frame


def test_a_streak_that_fades_alike_to_both_ends_is_found_in_its_middle() -> None:
    np.testing.assert_allclose(register(streak(4.0, 4.0)).features, [MIDDLE], atol=0.1)


@pytest.mark.parametrize("tail", [12.0, 12.5, 13.0])
def test_a_streak_whose_middle_moves_with_what_is_compared_has_none(tail: float) -> None:
    """Each middle that is tried has another one beyond it, along the tail."""
    found = register(streak(0.9, tail))
    assert np.isnan(found.features).all()
    assert QualityFlag(found.flags[0]) & QualityFlag.NOT_SYMMETRIC
