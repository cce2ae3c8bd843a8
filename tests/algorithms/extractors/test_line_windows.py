"""Middles of an L's lines whose edges' places in the pixels are known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from algorithms.extractors.frames.line_windows import LineWindows

WIDTH = 8.3


def covered(size, middle, width, soft=1.3):
    """Light on each pixel of a line whose edges are those of a blur by a Gaussian, exactly."""

    def primitive(u):  # of the blurred edge
        bell = np.exp(-0.5 * (u / soft) ** 2) / np.sqrt(2.0 * np.pi)
        return u * ndtr(u / soft) + soft * bell

    edges = np.arange(size + 1) - 0.5 - middle
    return np.diff(primitive(edges + width / 2.0) - primitive(edges - width / 2.0))


def lines(x, y, light=500.0, shape=(80, 84)):
    upright = np.outer(covered(shape[0], y + 35.0, 40.0), covered(shape[1], x, WIDTH))
    flat = np.outer(covered(shape[0], y, WIDTH), covered(shape[1], x + 35.0, 40.0))
    return light * (upright + flat)


@pytest.mark.parametrize("place", [(20.0, 18.0), (20.5, 18.5), (20.29, 17.64), (19.83, 18.41)])
def test_middles_of_lines_that_pixels_integrate_are_found(place):
    found = LineWindows(WIDTH).extract(lines(*place)[None] + 30.0)
    np.testing.assert_allclose(found, [place], atol=5e-4)


def test_neither_gain_nor_whole_pixels_change_more_than_they_are():
    frame = lines(20.29, 17.64)
    one = LineWindows(WIDTH).extract(frame[None])
    np.testing.assert_allclose(LineWindows(WIDTH).extract(3.0 * frame[None]), one, atol=1e-9)
    moved = np.roll(frame, (2, 3), axis=(0, 1))[None]
    np.testing.assert_allclose(
        LineWindows(WIDTH).extract(moved), one + np.array([3.0, 2.0]), atol=1e-9
    )


def test_a_frame_without_lines_has_no_middle():
    frames = np.stack(
        [np.full((60, 60), 7.0), np.random.default_rng(3).normal(50.0, 2.0, (60, 60))]
    )
    assert np.isnan(LineWindows(WIDTH).extract(frames)).all()


def test_stated_covariance_is_the_scatter_of_noisy_frames():
    rng = np.random.default_rng(8)
    frame = lines(20.29, 17.64)
    frames = frame + rng.normal(30.0, np.sqrt(4.0 + 0.1 * frame), (400, *frame.shape))
    found = LineWindows(WIDTH, softness_px=1.5).measure(frames)
    scatter = found.features.var(axis=0)
    stated = found.covariance[:, [0, 1], [0, 1]].mean(axis=0)
    np.testing.assert_allclose(stated, scatter, rtol=0.2)
    np.testing.assert_allclose(found.features.mean(axis=0), (20.29, 17.64), atol=2e-3)
