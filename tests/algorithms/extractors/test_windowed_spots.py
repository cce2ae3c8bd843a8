"""Moving windows on spots whose centres are known: pixels integrate them in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from algorithms.extractors.frames.multi_spot.spot_windows import window_centres
from algorithms.extractors.frames.multi_spot.windowed_array import WindowedArray
from algorithms.extractors.frames.multi_spot.windowed_list import WindowedList

HOLES = ((-16.0, -12.0, 6.0), (17.0, -11.0, 6.0), (-15.0, 14.0, 6.0), (18.0, 13.0, 6.0))


def integrated(size, centre, wide):
    """A Gaussian's share of each pixel of a line."""
    return np.diff(ndtr((np.arange(size + 1) - 0.5 - centre) / wide))


def gaussian(shape, centre, wide=2.0, long=2.0, light=30_000.0):
    """A Gaussian spot, integrated over pixels exactly."""
    return light * np.outer(
        integrated(shape[0], centre[1], long), integrated(shape[1], centre[0], wide)
    )


def centres_of(frame, starts, deviation=1.5, cap=14.0, factor=1.3):
    return window_centres(frame, 0.0, np.array(starts, dtype=np.float64), deviation, cap, factor)


@pytest.mark.parametrize("centre", [(20.0, 20.0), (20.5, 19.5), (20.31, 19.77), (19.62, 20.08)])
def test_centre_of_a_gaussian_that_pixels_integrate_is_found(centre):
    frame = gaussian((41, 41), centre, 1.8, 2.6)
    found = centres_of(frame, [(20, 20)])[0]
    np.testing.assert_allclose(found[:2], centre, atol=2e-5)


def test_neither_gain_nor_whole_pixels_change_more_than_they_are():
    frame = gaussian((41, 45), (20.3, 19.8))
    one = centres_of(frame, [(20, 20)])[0]
    np.testing.assert_allclose(centres_of(7.0 * frame, [(20, 20)])[0, :2], one[:2], atol=1e-9)
    moved = centres_of(np.roll(frame, (3, -2), axis=(0, 1)), [(18, 23)])[0]
    np.testing.assert_allclose(moved[:2], one[:2] + np.array([-2.0, 3.0]), atol=1e-9)


def test_a_window_at_the_edge_shrinks_and_one_within_it_finds_nothing():
    frame = gaussian((40, 40), (30.0, 20.2)) + gaussian((40, 40), (6.2, 20.3))
    found = centres_of(frame, [(30, 20), (6, 20), (1, 3)])
    np.testing.assert_allclose(found[1, :2], (6.2, 20.3), atol=3e-4)
    assert np.isnan(found[2]).all()


def test_noise_scatters_centres_as_sums_of_independent_pixels_do():
    rng = np.random.default_rng(4)
    deviation, wide, factor, light = 8.0, 2.0, 1.3, 30_000.0
    frame = gaussian((41, 41), (20.3, 19.8), wide, wide, light)
    found = [
        centres_of(frame + rng.normal(0.0, deviation, frame.shape), [(20, 20)], factor=factor)[0, 0]
        for _ in range(300)
    ]
    # of the window of variance a^2 over a Gaussian of variance b^2 (pixels' box included)
    b2 = wide**2 + 1.0 / 12.0
    a2 = factor**2 * b2
    noise = deviation * np.sqrt(np.pi / 2.0) * a2  # root of the sum of (u w)^2
    slope = light * a2 * a2 / (a2 + b2) ** 2
    assert np.std(found) == pytest.approx(noise / slope, rel=0.12)


def masked(displacement, light=30_000.0):
    frame = np.zeros((60, 64))
    for x, y, _ in HOLES:
        frame += gaussian(frame.shape, (x + displacement[0], y + displacement[1]), light=light)
    return frame


def test_array_lists_each_aperture_in_its_place():
    lists = WindowedArray(HOLES).extract(masked((31.3, 28.8))[None] + 20.0).reshape(4, 3)
    expected = np.array(HOLES)[:, :2] + (31.3, 28.8)
    np.testing.assert_allclose(lists[:, :2], expected, atol=1e-3)
    assert (lists[:, 2] > 0.0).all()


@pytest.mark.parametrize("make", [WindowedArray, lambda holes: WindowedList(holes, spots=4)])
def test_empty_frame_has_no_list(make):
    assert np.isnan(make(HOLES).extract(np.full((1, 60, 64), 20.0))).all()
