"""The parts of the energy filter, each beside NumPy, on frames wider than high.

Parts of the kernel are called as Python (`py_func`): compiled they are inside what is called whole.
"""

import math

import numpy as np
import pytest

from algorithms.extractors.frames.energy_filter_kernel import (
    energy_centre,
    filter_sequence,
    shift_of,
    size_of,
)


def spot(x, y, height=14, width=23, sigma=(2.0, 1.5)):
    rows, columns = np.mgrid[:height, :width]
    return np.exp(-(((columns - x) / sigma[0]) ** 2) / 2 - ((rows - y) / sigma[1]) ** 2 / 2)


def test_the_ellipse_of_scattered_pixels_is_that_of_their_covariance():
    rng = np.random.default_rng(3)
    for _ in range(20):
        energies = np.zeros((21, 23))
        energies[1:-1, 1:-1] = 4.0 * (rng.uniform(size=(19, 21)) < 0.1)
        lit = np.argwhere(energies > 0)
        covariance = np.cov(lit.T, bias=True) + np.eye(2) / 12
        limit = 4 * math.pi * math.sqrt(np.linalg.det(covariance)) / len(lit)
        assert energy_centre(energies, 1.0, limit * 1.001, np.zeros(2)) == len(lit)
        assert energy_centre(energies, 1.0, limit * 0.999, np.zeros(2)) == 0


def test_the_shift_and_the_variance_it_leaves_are_numpys_least_squares():
    energies = 500 * spot(11.2, 6.4)
    frame = 500 * spot(11.35, 6.3) + np.random.default_rng(2).normal(0, 4.0, energies.shape)
    cut = 60.0
    information, shift = np.zeros(3), np.zeros(2)
    variance = shift_of.py_func(frame, energies, 0.0, cut, information, shift)
    above = energies > cut
    g_y, g_x = np.gradient(energies)
    design = -np.column_stack([g_x[above], g_y[above]])
    change = (frame - energies)[above]
    solution, residual, *_ = np.linalg.lstsq(design, change)
    np.testing.assert_allclose(shift, solution, rtol=1e-10)
    assert variance == pytest.approx(residual[0] / (above.sum() - 2), rel=1e-10)
    products = design.T @ design
    np.testing.assert_allclose(information, [products[0, 0], products[0, 1], products[1, 1]])
    assert size_of(shift, information) == pytest.approx(solution @ products @ solution)


def test_late_frames_replace_earlier_ones_at_the_rate_of_the_memory():
    """A still spot whose brightness alone changes: E moves by (I - E) / memory."""
    bright = [100.0, 110.0, 90.0, 120.0, 100.0]
    frames = np.stack([b * spot(11.2, 6.4) for b in bright])
    frames.setflags(write=False)  # as extractors get them
    found, lengths = np.zeros((5, 2)), np.zeros(5, dtype=np.int64)
    usable = np.ones(5, dtype=bool)
    filter_sequence(frames, usable, 5.0, 0.2, 2.0, 3, 1e9, 0.1, found, lengths)
    assert lengths.tolist() == [1, 2, 3, 3, 3]
    again = np.zeros((5, 2))
    usable[2] = False
    filter_sequence(frames, usable, 5.0, 0.2, 2.0, 3, 1e9, 0.1, again, lengths)
    assert lengths.tolist() == [1, 2, 0, 3, 3]
    assert np.isnan(again[2]).all()
    filter_sequence(frames, usable, 5.0, 0.2, 2.0, 1, 1e9, 0.1, again, lengths)
    assert lengths.tolist() == [1, 1, 0, 1, 1]
