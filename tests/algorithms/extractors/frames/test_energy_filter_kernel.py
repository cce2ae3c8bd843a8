"""The parts of the energy filter, each beside NumPy, on frames wider than high.

Parts of the kernel are called as Python (`py_func`): compiled they are inside what is called whole.
"""

import math

import numpy as np
import pytest

from algorithms.extractors.frames.energy_filter_kernel import (
    border_level,
    energy_centre,
    filter_sequence,
    shift_of,
    size_of,
)


def spot(x, y, height=14, width=23, sigma=(2.0, 1.5)):
    rows, columns = np.mgrid[:height, :width]
    return np.exp(-(((columns - x) / sigma[0]) ** 2) / 2 - ((rows - y) / sigma[1]) ** 2 / 2)


@pytest.mark.parametrize("shape", [(4, 9), (9, 4), (2, 5), (5, 2), (1, 6), (6, 1), (3, 3)])
def test_the_border_is_every_outermost_pixel_once(shape):
    frame = np.random.default_rng(1).uniform(100, 200, shape)
    rim = np.ones(shape, dtype=bool)
    rim[1:-1, 1:-1] = False
    count = 2 * shape[1] + 2 * max(shape[0] - 2, 0)
    if rim.sum() == count:  # but for a single row or column, which counts twice over
        assert border_level.py_func(frame) == pytest.approx((frame[rim].mean(), frame[rim].var()))
    assert border_level.py_func(np.full(shape, 7.0))[1] == 0.0


def test_the_centre_is_of_the_light_above_the_cut():
    energies = 100 * spot(12.3, 6.2)
    centre = np.zeros(2)
    above = np.maximum(energies - 20.0, 0.0)
    rows, columns = np.indices(energies.shape)
    assert energy_centre(energies, 20.0, 2.0, centre) == (energies > 20.0).sum()
    expected = (above * columns).sum() / above.sum(), (above * rows).sum() / above.sum()
    np.testing.assert_allclose(centre, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("row", "column", "found"),
    [(1, 5, 2), (0, 5, 0), (12, 5, 2), (13, 5, 0), (6, 0, 0), (6, 1, 2), (6, 21, 2), (6, 22, 0)],
)
def test_light_on_the_border_is_a_cut_spot(row, column, found):
    energies = np.zeros((14, 23))
    energies[row, column] = 9.0
    inner = min(max(row, 1), 12), min(max(column + (1 if column < 11 else -1), 1), 21)
    energies[inner] = 9.0
    assert energy_centre(energies, 1.0, 2.0, np.zeros(2)) == found


def test_one_pixel_is_no_spot_and_what_equals_the_cut_is_not_above_it():
    energies = np.zeros((9, 11))
    energies[4, 5] = energies[4, 6] = 3.0
    centre = np.zeros(2)
    assert energy_centre(energies, 2.0, 2.0, centre) == 2
    np.testing.assert_array_equal(centre, [5.5, 4.0])
    energies[4, 6] = 2.0
    assert energy_centre(energies, 2.0, 2.0, centre) == 0


@pytest.mark.parametrize("axis", [0, 1])
def test_a_bar_is_one_spot_and_two_pixels_apart_are_not(axis):
    """A bar fills all but 3/pi of its ellipse at any length; two pixels leave what lies between."""
    for length in range(2, 10):
        energies = np.zeros((13, 13))
        bar = energies[6] if axis else energies[:, 6]
        bar[2 : 2 + length] = 5.0
        assert energy_centre(energies, 1.0, math.pi / 3 * 1.001, np.zeros(2)) == length
        assert energy_centre(energies, 1.0, math.pi / 3 * 0.999, np.zeros(2)) == 0
        bar[3 : 1 + length] = 0.0
        apart = (length - 1) ** 2 / 4 + 1 / 12
        limit = 2 * math.pi * math.sqrt(apart / 12)
        assert energy_centre(energies, 1.0, limit * 1.001, np.zeros(2)) == 2
        assert energy_centre(energies, 1.0, limit * 0.999, np.zeros(2)) == 0


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


@pytest.mark.parametrize(
    ("gain", "expected"), [(1.49, True), (1.51, False), (0.51, True), (0.49, False)]
)
def test_light_half_as_bright_again_or_half_gone_is_another(gain, expected):
    energies = 500 * spot(11.2, 6.4) + 30.0
    frame = gain * (energies - 30.0) + 30.0
    variance = shift_of.py_func(frame, energies, 30.0, 90.0, np.zeros(3), np.zeros(2))
    assert math.isnan(variance) is not expected


def test_a_shift_needs_four_pixels_and_two_slopes():
    for pixels, expected in ((3, False), (4, True)):
        energies = np.random.default_rng(3).uniform(0, 1, (6, 9))
        energies[2, 2 : 2 + pixels] += 10.0
        variance = shift_of.py_func(energies, energies, 0.0, 5.0, np.zeros(3), np.zeros(2))
        assert math.isnan(variance) is not expected
    ridge = np.tile(10.0 + np.arange(9.0), (6, 1))  # no slope from row to row
    assert math.isnan(shift_of.py_func(ridge, ridge, 0.0, 5.0, np.zeros(3), np.zeros(2)))


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
