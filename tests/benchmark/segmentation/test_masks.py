"""Masks and what is left of frames under them: against frames whose light is known."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark.learned.network import INPUT, Layer, Network
from benchmark.segmentation.masks import Marked, Masks, NetworkMasks, above_share, discs

Y, X = np.mgrid[:64, :64].astype(np.float64)


def spot(x: float, y: float, light: float = 300.0) -> np.ndarray:
    return light * np.exp(-((X - x) ** 2 + (Y - y) ** 2) / 18.0)


def centre(light: np.ndarray) -> tuple[float, float]:
    return float((light * X).sum() / light.sum()), float((light * Y).sum() / light.sum())


def bright(share: float = 0.3) -> Network:
    """Return a network whose odds are those of a threshold over the peak."""
    weight = np.array([0.0, 60.0], dtype=np.float32).reshape(1, 2, 1, 1)
    bias = np.array([-60.0 * share], dtype=np.float32)
    layer = Layer("odds", "convolution", (INPUT,), (1, 2, 1, 1))
    return Network((layer,), {"odds": (weight, bias)}, {})


def test_a_threshold_of_half_the_peak_marks_half_the_height_of_a_gaussian() -> None:
    # exp(-r^2 / 18) = 1/2 at r^2 = 18 ln 2
    (found,) = above_share(spot(30, 33)[None], 0.5)
    within = np.hypot(X - 30, Y - 33) < np.sqrt(18 * np.log(2))
    assert found.sum() == within.sum()


def test_a_disc_has_the_area_of_a_circle_and_none_without_a_centre() -> None:
    found = discs(np.zeros((2, 64, 64)), np.array([[31.2, 30.7], [np.nan, np.nan]]), 9.0)
    assert found[0].sum() == pytest.approx(np.pi * 81, rel=0.02)
    assert not found[1].any()


def test_an_even_background_is_taken_off_and_part_of_a_sloping_one() -> None:
    mask = (spot(30.3, 33.6) > 60.0)[None]
    for slope, off in ((0.0, 0.02), (0.8, 0.16)):
        frame = (spot(30.3, 33.6) + 5.0 + slope * X)[None]
        left = Marked.of(frame, Masks(mask, np.array([False]))).cut_out
        assert centre(left[0]) == pytest.approx((30.3, 33.6), abs=off)
        assert not left[0, :10].any()
    # what a constant background leaves under the same mask
    left = np.where(left[0] != 0.0, frame[0] - np.median(frame), 0.0)
    assert abs(centre(left)[0] - 30.3) > 0.25


def test_another_light_is_taken_out_and_noise_is_kept() -> None:
    noise = np.random.default_rng(3).normal(0.0, 1.0, (64, 64))
    frame = (spot(20, 20) + spot(48, 45, 200.0) + noise)[None]
    mask = (spot(20, 20) > 20.0)[None]
    left = Marked.of(frame, Masks(mask, np.array([False]))).without_others[0]
    assert np.abs(left[35:, 38:]).max() < 5.0
    assert left[:40, 40:].std() == pytest.approx(1.0, abs=0.2)
    assert left[20, 20] == pytest.approx(300.0, abs=5.0)


def test_masks_unlike_those_of_the_calibration_are_refused() -> None:
    clean = np.stack([spot(x, 30) for x in (25.0, 30.0, 35.0)])
    masks = NetworkMasks(bright()).calibrated(clean)
    two = spot(15, 20) + spot(48, 45)
    wide = 300.0 * np.exp(-((X - 30) ** 2 + (Y - 30) ** 2) / 60.0)
    found = masks(np.stack([spot(28, 33), two, wide, np.zeros((64, 64))]))
    assert found.refused.tolist() == [False, True, True, True]
