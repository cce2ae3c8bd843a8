"""The parts that cameras' and events' extractors are made of, in closed form or beside SciPy.

Parts of a kernel are called as Python (`py_func`): compiled they are inside what extractors call.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import ndimage

from algorithms.extractors.frames.cameras import circles_kernel as circles
from algorithms.extractors.frames.cameras import dark_holes_kernel as holes
from algorithms.extractors.frames.cameras.hough import HoughCircle

# Circles


@pytest.mark.parametrize("shape", [(9, 14), (14, 9)])
def test_the_gradient_is_sobel_s_but_for_the_border(shape):
    frame = np.random.default_rng(1).integers(0, 99, shape).astype(np.uint16)
    across, down, size = (np.zeros(shape) for _ in range(3))
    steepest = circles._gradient.py_func(frame, across, down, size)
    inner = (slice(1, -1), slice(1, -1))
    for axis, found in ((1, across), (0, down)):
        expected = ndimage.sobel(frame.astype(float), axis=axis) / 8
        np.testing.assert_allclose(found[inner], expected[inner])
        assert np.count_nonzero(found) == np.count_nonzero(expected[inner])
    np.testing.assert_allclose(size, np.hypot(across, down))
    assert steepest == size.max()


@pytest.mark.parametrize("turn_deg", [0.0, 20.0, 60.0, 90.0, 130.0, 200.0, 300.0])
def test_edges_lie_where_a_blurred_step_is_steepest(turn_deg):
    c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    rows, columns = np.mgrid[:17, :25]
    away = (columns - 12.3) * c + (rows - 8.2) * s
    frame = 100.0 / (1.0 + np.exp(-away))
    across, down, size = (np.zeros(frame.shape) for _ in range(3))
    circles._gradient.py_func(frame, across, down, size)
    edges = np.empty((frame.size, 5))
    count = circles._edges(across, down, size, 10.0, edges)
    assert count >= 8
    x, y, unit_x, unit_y, height = edges[:count].T
    np.testing.assert_allclose((x - 12.3) * c + (y - 8.2) * s, 0.0, atol=0.08)
    np.testing.assert_allclose(unit_x, c, atol=0.02)
    np.testing.assert_allclose(unit_y, s, atol=0.02)
    assert (height >= 10.0).all()
    assert circles._edges(across, down, size, 1e3, edges) == 0


def test_a_circle_of_faint_light_is_the_same_circle():
    rows, columns = np.mgrid[:60, :64]
    frame = 1.0 / (1.0 + np.exp(np.hypot(columns - 31.3, rows - 28.6) - 9.0))
    expected = [[31.3, 28.6, 9.0]]
    for gain in (1000.0, 1.0, 1e-3):
        found = HoughCircle().circles((gain * frame)[None])
        np.testing.assert_allclose(found, expected, atol=0.1)


# Dark holes


@pytest.mark.parametrize("shape", [(9, 14), (14, 9), (3, 2)])
def test_frames_are_blurred_as_by_scipy(shape):
    frame = np.random.default_rng(1).integers(0, 99, shape).astype(np.uint16)
    taps = np.array([0.1, 0.2, 0.4, 0.2, 0.1])
    rows, out = np.empty(shape), np.empty(shape)
    holes.blur.py_func(frame, taps, rows, out)
    across = ndimage.convolve1d(frame.astype(float), taps, axis=1, mode="nearest")
    np.testing.assert_allclose(rows, across)
    np.testing.assert_allclose(out, ndimage.convolve1d(across, taps, axis=0, mode="nearest"))


# First spikes
