"""Centres by heat map: what a network is shown, and centres whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark.learned.centres import (
    CentreReader,
    Look,
    folded,
    layers,
    soft_argmax,
    unfolded,
    windows,
)
from benchmark.learned.network import Network

LOOK = Look(window_px=24, box_px=7)


def spots(*places: tuple[float, float], shape: tuple[int, int] = (60, 80)) -> np.ndarray:
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    return np.stack(
        [1000.0 * np.exp(-((columns - x) ** 2 + (rows - y) ** 2) / 8.0) for x, y in places]
    )


def test_maps_of_zeros_give_the_centroid_of_a_spot() -> None:
    places = np.array([(40.25, 30.75), (33.4, 21.1), (12.5, 47.0)])
    found, statistics = CentreReader(None, LOOK).read(spots(*places))
    np.testing.assert_allclose(found, places, atol=2e-3)
    # a Gaussian of 2 px
    np.testing.assert_allclose(np.exp(statistics[:, :2]), 2.0, atol=2e-2)


def test_a_map_that_singles_out_a_pixel_gives_that_pixel() -> None:
    heat, light = np.zeros((1, 2, 6, 6)), np.ones((1, 1, 6, 6))
    heat[0, 0, 2, 4] = heat[0, 1, 5, 1] = 60.0
    found = soft_argmax(heat, light)
    np.testing.assert_allclose(found.centre, [[4.0, 5.0]], atol=1e-9)
    np.testing.assert_allclose(found.spread, 0.0, atol=1e-6)


def test_windows_stop_at_the_edge_with_zeros_and_average_pixels_first() -> None:
    shown = windows(LOOK, spots((5.0, 30.0)))
    assert shown.corner[0].tolist() == [5 - 12, 30 - 12]
    assert not shown.light[0, 0, :, :7].any()
    half = windows(Look(24, 7, pool=2), spots((40.5, 30.5)))
    assert half.corner[0].tolist() == [20 - 12, 15 - 12]
    centres, _ = CentreReader(None, Look(24, 7, pool=2)).read(spots((40.5, 30.5)))
    np.testing.assert_allclose(centres, [[40.5, 30.5]], atol=1e-2)


def test_a_second_spot_outside_the_window_is_told_by_the_light_beyond_it() -> None:
    one, two = spots((20.0, 20.0)), spots((60.0, 40.0))
    shown = windows(LOOK, np.concatenate([one, one + 0.5 * two]))
    np.testing.assert_allclose(shown.beyond, [0.0, 0.5], atol=1e-3)


def test_frames_without_light_and_those_beyond_the_limits_have_no_centre() -> None:
    limits = ((-9.0, 9.0), (-9.0, 9.0), (np.log(500.0), np.log(900.0)), (-9.0, 0.5))
    frames = np.concatenate([np.zeros((1, 60, 80)), spots((30.0, 30.0)), 3.0 * spots((30.0, 30.0))])
    found, _ = CentreReader(None, LOOK, limits).read(frames)
    assert np.isfinite(found).all(axis=1).tolist() == [False, True, False]


def test_folding_keeps_2_by_2_pixels_together_and_unfolding_undoes_it() -> None:
    light = np.arange(2 * 36, dtype=np.float32).reshape(2, 1, 6, 6)
    channels = folded(light)
    assert channels[0, :, 0, 0].tolist() == [0, 1, 6, 7]
    both = np.concatenate([channels, channels], axis=1)
    np.testing.assert_array_equal(unfolded(both), np.repeat(light, 2, axis=1))


@pytest.mark.parametrize("side", [24, 32])
def test_layers_keep_the_size_of_the_window(side) -> None:
    made, drawn = layers(4), np.random.default_rng(1)
    weights = {
        one.name: (
            drawn.normal(size=one.shape).astype(np.float32),
            np.zeros(one.shape[0], dtype=np.float32),
        )
        for one in made
        if one.shape
    }
    heat = unfolded(Network(made, weights, {})(folded(np.ones((2, 1, side, side), np.float32))))
    assert heat.shape == (2, 2, side, side)
