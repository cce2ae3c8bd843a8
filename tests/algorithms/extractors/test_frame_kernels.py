"""The parts that extractors of frames are made of, each beside NumPy, on frames not square.

Parts of a kernel are called as Python (`py_func`): compiled they are inside what extractors call.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import ndimage

from algorithms.extractors.frames import balance_kernel, gaussian_kernel
from algorithms.extractors.frames.background import background_level
from algorithms.extractors.frames.windows import MAX_MOVES, centred_windows, follow_spot
from algorithms.kernels import moments, window_sums

SHAPES = [(13, 29), (29, 13), (24, 25), (5, 7)]


def noise(shape, seed=1):
    return np.random.default_rng(seed).uniform(10, 90, shape)


# Sums over frames


@pytest.mark.parametrize("width", [1, 2, 3, 4, 5, 7, 8, 9])
def test_maxima_profiles_and_brightest_are_numpys_at_every_width(width):
    frames = np.random.default_rng(width).integers(0, 50, (3, 4, width)).astype(np.uint16)
    frames.setflags(write=False)  # as extractors get them: compiled once for both
    maxima = np.empty((3, 4), dtype=np.uint16)
    moments.row_maxima(frames, maxima)
    np.testing.assert_array_equal(maxima, frames.max(axis=2))
    columns, rows = moments.axis_sums(frames)
    assert columns.dtype == rows.dtype == np.int64
    np.testing.assert_array_equal(rows, frames.sum(axis=2))
    np.testing.assert_array_equal(columns, frames.sum(axis=1))
    y, x = np.divmod(frames.reshape(3, -1).argmax(axis=1), width)
    np.testing.assert_array_equal(moments.first_brightest(frames, maxima), np.column_stack([x, y]))
    np.testing.assert_array_equal(moments.whole_frame(frames), [[0, 4, 0, width]] * 3)
    assert moments.zero_of(frames).dtype == np.int64
    assert moments.zero_of(frames.astype(np.float32)).dtype == np.float64


def test_frames_without_contrast_or_with_a_hole_are_unusable():
    frames = np.full((5, 3, 4), 7.0)
    frames[1, 2, 3] = 8.0  # the last pixel alone
    frames[2, 0, 0] = 6.0
    frames[3, 2, 3] = np.nan
    frames[4, 1, 1] = np.inf
    frames.setflags(write=False)
    assert moments.unusable_frames(frames).tolist() == [True, False, False, True, True]


@pytest.mark.parametrize("window", [(0, 9, 0, 14), (2, 7, 3, 11), (0, 1, 13, 14), (8, 9, 0, 2)])
def test_moments_above_a_level_are_over_the_window_alone(window):
    frames = np.random.default_rng(2).integers(0, 30, (1, 9, 14)).astype(np.int64)
    top, bottom, left, right = window
    out = np.empty((1, 6), dtype=np.int64)
    level = np.array([12], dtype=np.int64)
    moments.moments_above.py_func(frames, frames.max(axis=2), level, np.array([window]), out)
    rows, columns = np.mgrid[top:bottom, left:right]
    part = frames[0, top:bottom, left:right]
    u = np.where(part > 12, part - 12, 0)
    lit = part > 12
    assert out[0].tolist() == [
        u.sum(), (columns * u).sum(), (rows * u).sum(),
        lit.sum(), columns[lit].sum(), rows[lit].sum(),
    ]  # fmt: skip


@pytest.mark.parametrize("reach", [1, 2, 4])
@pytest.mark.parametrize("window", [(0, 9, 0, 14), (2, 7, 3, 11), (0, 2, 12, 14), (4, 5, 6, 7)])
def test_box_moments_are_those_of_the_frame_filtered(window, reach):
    frames = np.random.default_rng(3).integers(0, 30, (1, 9, 14)).astype(np.uint16)
    frames.setflags(write=False)
    top, bottom, left, right = window
    out = np.empty((1, 6), dtype=np.int64)
    moments.box_moments(frames, np.array([window]), reach, np.int64(0), out)
    side = 2 * reach + 1
    rows, columns = np.mgrid[top:bottom, left:right]
    expected = []
    for image in (frames[0].astype(int), np.ones(frames.shape[1:], int)):
        box = ndimage.convolve(image, np.ones((side, side), dtype=int), mode="constant")
        part = box[top:bottom, left:right]
        expected += [part.sum(), (columns * part).sum(), (rows * part).sum()]
    assert out[0].tolist() == expected


def test_a_box_holds_all_pixels_as_bright_as_the_brightest():
    frames = np.zeros((2, 9, 14), dtype=np.uint16)
    frames[0, [2, 6, 4], [11, 3, 5]] = 9
    frames[1, 8, 13] = 5
    out = np.empty((2, 4), dtype=np.int64)
    window_sums.boxes_of_maxima.py_func(frames, frames.max(axis=2), out)
    assert out.tolist() == [[3, 2, 11, 6], [13, 8, 13, 8]]


@pytest.mark.parametrize(
    ("x", "y", "inside"),
    [(2, 2, True), (11, 6, True), (1, 4, False), (12, 4, False), (5, 1, False), (5, 7, False)],
)
def test_sums_of_a_window_are_told_where_it_is_whole(x, y, inside):
    frames = noise((1, 9, 14))
    out = np.empty((1, 2, 5))
    window_sums.window_profiles.py_func(frames, np.array([[x, y]]), 2, out)
    if inside:
        part = frames[0, y - 2 : y + 3, x - 2 : x + 3]
        np.testing.assert_allclose(out[0], [part.sum(axis=0), part.sum(axis=1)])
    else:
        assert np.isnan(out).all()


# Windows and backgrounds


def test_windows_are_cut_at_the_edges_of_the_frame():
    found = centred_windows(np.array([[0.4, 8.6], [13.0, 0.0], [6.5, 4.0]]), 5, 9, 14)
    assert found.tolist() == [[7, 9, 0, 3], [0, 3, 11, 14], [2, 7, 4, 9]]


def test_a_window_follows_what_it_holds_until_it_stays():
    asked = []

    def towards(windows):
        asked.append(windows.tolist())
        middle = (windows[:, [2, 0]] + windows[:, [3, 1]] - 1) / 2
        return np.minimum(middle + 2.0, [[20.0, 10.0]])

    found = follow_spot(np.array([[10.0, 4.0]]), 5, (40, 60), towards)
    assert found.tolist() == [[20.0, 10.0]]
    assert len(asked) == 6  # five moves, and the last finds it where it was
    asked.clear()

    def away(windows):
        asked.append(windows.tolist())
        return (windows[:, [2, 0]] + windows[:, [3, 1]] - 1) / 2 + 2.0

    follow_spot(np.array([[3.0, 3.0]]), 3, (200, 300), away)
    assert len(asked) == MAX_MOVES + 1
    # an answer outside the frame moves no window
    outside = np.array([[14.1, 3.0]])
    assert follow_spot(np.array([[5.0, 4.0]]), 5, (9, 15), lambda w: outside) is outside


@pytest.mark.parametrize("shape", [(4, 7), (7, 4)])
def test_the_border_s_median_is_of_the_outermost_pixels(shape):
    frames = noise((2, *shape))
    frames[:, 1:-1, 1:-1] += 1000.0
    rim = np.ones(shape, dtype=bool)
    rim[1:-1, 1:-1] = False
    expected = [np.median(frame[rim]) for frame in frames]
    np.testing.assert_allclose(background_level(frames, "border"), expected)
    np.testing.assert_allclose(
        background_level(frames, "median"), np.median(frames.reshape(2, -1), axis=1)
    )
    assert background_level(frames, "none").tolist() == [0.0, 0.0]


# Five areas


@pytest.mark.parametrize("shape", SHAPES)
def test_a_window_over_the_edge_is_filled_up_with_its_rim(shape):
    frame = noise(shape)
    height, width = shape
    columns, rows = np.empty(21), np.empty(21)
    for y in range(0, height, 2):
        for x in range(0, width, 3):
            first = balance_kernel._window_sums.py_func(frame, x, y, columns, rows)
            window = np.full((21, 21), np.nan)
            for i in range(max(y - 10, 0), min(y + 11, height)):
                for j in range(max(x - 10, 0), min(x + 11, width)):
                    window[i - y + 10, j - x + 10] = frame[i, j]
            inside = ~np.isnan(window)
            rim = inside.copy()
            rim[1:-1, 1:-1] = False
            window[~inside] = window[rim].mean() if rim.any() else 0.0
            np.testing.assert_allclose(columns, window.sum(axis=0))
            np.testing.assert_allclose(rows, window.sum(axis=1))
            across, down = np.flatnonzero(inside.any(axis=0)), np.flatnonzero(inside.any(axis=1))
            assert first == (across[0], across[-1], down[0], down[-1])


@pytest.mark.parametrize("side", [1, -1])
def test_the_balance_moves_half_the_difference_over_the_centres_rise(side):
    sums = np.full(21, 3.0)
    sums[7:14] = 23.0
    assert balance_kernel._balance(sums, 0, 20) == (0.0, True)
    sums[10 + 3 * side] += 8.0
    assert balance_kernel._balance(sums, 0, 20)[0] == pytest.approx(side * 0.5 * 8.0 / 20.0)
    sums[10 + 3 * side] += 1000.0
    assert balance_kernel._balance(sums, 0, 20)[0] == side * 5.0  # half of the window's half
    edge = np.full(21, 3.0)
    edge[10] = 23.0
    for light, whole in ((9.9, True), (10.1, False)):  # half of the centre's 20 apart
        edge[0 if side < 0 else 20] = 3.0 + light
        assert balance_kernel._balance(edge, 0, 20)[1] == whole


# Gaussian fit


def test_a_gaussian_starts_from_the_pixels_brighter_than_half():
    frame = np.full((12, 19), 5.0)
    frame[4:7, 8:13] = 25.0
    frame[5, 10] = 45.0
    p = np.empty(6)
    assert gaussian_kernel._start.py_func(frame, p)
    lit = frame > 25.0
    radius = math.sqrt(lit.sum() / (2 * math.pi * math.log(2)))
    np.testing.assert_allclose(p, [40.0, 10.0, 5.0, max(radius, 0.5), max(radius, 0.5), 5.0])
    frame[4:7, 8:13] = 26.0
    assert gaussian_kernel._start.py_func(frame, p)
    radius = math.sqrt(15 / (2 * math.pi * math.log(2)))
    np.testing.assert_allclose(p[1:5], [10.0, 5.0, radius, radius])
    assert not gaussian_kernel._start.py_func(np.full((12, 19), 5.0), p)


def gaussian(p, height, width):
    rows, columns = np.mgrid[:height, :width]
    t, s = (columns - p[1]) / p[3], (rows - p[2]) / p[4]
    return p[5] + p[0] * np.exp(-(t**2) / 2 - s**2 / 2)


def test_the_normal_equations_of_a_gaussian_are_those_of_differences():
    height, width = 11, 17
    p = np.array([30.0, 7.3, 4.6, 2.1, 1.4, 5.0])
    frame = noise((height, width))
    x, y, along = np.empty((3, width)), np.empty((3, height)), np.zeros((5, width))
    gaussian_kernel._factors.py_func(p, 0, x)
    gaussian_kernel._factors.py_func(p, 1, y)
    projected, matrix = np.empty(6), np.empty((6, 6))
    total = gaussian_kernel._residual_sums.py_func(frame, p, x, y, along, projected)
    gaussian_kernel._normal_matrix(p, x, y, matrix)
    slopes = []
    for k in range(6):
        step = np.zeros(6)
        step[k] = 1e-6
        change = gaussian(p + step, height, width) - gaussian(p - step, height, width)
        slopes.append((change / 2e-6).ravel())
    design = np.array(slopes).T
    rest = (frame - gaussian(p, height, width)).ravel()
    assert total == pytest.approx(rest @ rest)
    np.testing.assert_allclose(projected, design.T @ rest, rtol=1e-6)
    np.testing.assert_allclose(matrix, design.T @ design, rtol=1e-6, atol=1e-5)


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_damped_equations_are_solved_and_singular_ones_refused(damping):
    rng = np.random.default_rng(5)
    design = rng.normal(size=(9, 6))
    matrix, right, step = design.T @ design, rng.normal(size=6), np.empty(6)
    work = np.empty((6, 6))
    assert gaussian_kernel._step(matrix, right, damping, work, step)
    damped = matrix + damping * np.diag(np.diag(matrix))
    np.testing.assert_allclose(step, np.linalg.solve(damped, right), rtol=1e-8)
    matrix[:, 5] = matrix[5] = 0.0
    assert not gaussian_kernel._step(matrix, right, damping, work, step)
