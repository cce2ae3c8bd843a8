"""The parts that cameras' and events' extractors are made of, in closed form or beside SciPy.

Parts of a kernel are called as Python (`py_func`): compiled they are inside what extractors call.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import ndimage

from algorithms.extractors.events import first_spikes_kernel as spikes
from algorithms.extractors.frames.cameras import blooming_kernel as blooming
from algorithms.extractors.frames.cameras import circles_kernel as circles
from algorithms.extractors.frames.cameras import dark_holes_kernel as holes
from algorithms.extractors.frames.cameras.hough import HoughCircle
from algorithms.kernels.regions import SIDES, flood

# Blooming lines


@pytest.mark.parametrize(
    ("row", "found"),
    [
        ("..##...", [(2.5, 2)]),
        ("#.....#", [(0.0, 1), (6.0, 1)]),
        ("##.##..", [(2.0, 5)]),  # one dead pixel does not end a run
        ("##..##.", [(0.5, 2), (4.5, 2)]),  # two do
        ("#.#.#.#", [(3.0, 7)]),
        (".....##", [(5.5, 2)]),
        ("####.#.", [(2.5, 6)]),
        (".......", []),
    ],
)
def test_runs_are_of_pixels_above_the_level_but_for_single_dead_ones(row, found):
    frame = np.zeros((3, 7))
    frame[1] = [9.0 if mark == "#" else 5.0 for mark in row]  # what equals the level is not above
    runs = np.full((12, 3), np.nan)
    count = blooming._runs.py_func(frame, 5.0, runs)
    assert runs[:count].tolist() == [[middle, 1.0, width] for middle, width in found]


def test_the_peak_is_of_the_line_most_runs_lie_on():
    turns = np.radians(np.linspace(-5, 5, 21))
    lean, r = math.radians(2.5), 21.0
    rows = np.arange(40.0)
    middles = (r - rows * math.sin(lean)) / math.cos(lean)
    runs = np.column_stack([middles, rows, np.ones(40)])
    most, found, turn = blooming._peak(runs, 40, turns, np.empty(300))
    assert turn == pytest.approx(lean)
    assert (most, found) == pytest.approx((40.0, r), abs=1e-9)
    # shared between two cells: halfway, the parabola's middle is exact
    runs[:, 0] = 12.5
    most, found, turn = blooming._peak(runs, 40, np.zeros(1), np.empty(300))
    assert (most, found, turn) == (20.0, pytest.approx(12.5), 0.0)
    assert math.isnan(blooming._peak(runs, 0, turns, np.empty(300))[1])


def test_a_line_s_own_runs_are_narrow_and_near_and_within_its_ends():
    turn, r = math.radians(-3.0), 15.0
    c, s = math.cos(turn), math.sin(turn)

    def run(place, away, width):
        return ((r + away) * c - place * s, (r + away) * s + place * c, width)

    runs = np.array(
        [run(5, 0.5, 1), run(6, -1.0, 3), run(7, 1.6, 2), run(8, 0.2, 9), run(20, 0.3, 2)]
    )
    mean = blooming._refine(runs, 5, r, turn, 4.0, (4.0, 10.0))
    assert mean == pytest.approx(r + (0.5 * 1 - 1.0 * 3) / 4)  # weighed by their widths
    assert math.isnan(blooming._refine(runs, 5, r, turn, 4.0, (30.0, 40.0)))
    assert blooming._typical_width(runs, 5, r, turn) == 2.5  # of 1, 3, 9 and 2
    assert blooming._widest(2.5) == pytest.approx(4.75)


def test_a_line_extends_over_rows_most_of_which_have_a_run():
    runs = np.array([(10.0, float(i), 2.0) for i in (3, 4, 6, 7, 8, 9, 12)])
    # seven rows of ten: enough, of eleven: too few
    assert blooming._extent(runs, 7, 10.0, 0.0, 2.0) == (3.0, 12.0, 3.0, 12.0, False)
    runs[-1, 1] = 13.0
    first, last, top, bottom, covered = blooming._extent(runs, 7, 10.0, 0.0, 2.0)
    assert math.isnan(first)
    assert math.isnan(last)
    assert (top, bottom, covered) == (3.0, 13.0, False)
    runs[-1] = (11.0, 12.0, 7.0)  # three times its width and one more
    assert not blooming._extent(runs, 7, 10.0, 0.0, 2.0)[4]
    runs[-1, 2] = 7.5
    assert blooming._extent(runs, 7, 10.0, 0.0, 2.0)[4]


def test_the_gradient_is_of_the_logarithm_of_the_light():
    rows, columns = np.mgrid[:7, :9]
    frame = 50.0 + 400.0 * np.exp(0.2 * columns - 0.1 * rows)
    light, x, y = blooming._slope.py_func(frame, 3, 4, 50.0, 1e6)
    assert (light, x, y) == pytest.approx((frame[3, 4] - 50.0, 0.2, -0.1))
    for place in ((3, 4), (3, 3), (3, 5), (2, 4), (4, 4)):
        saturated, dead = frame.copy(), frame.copy()
        saturated[place] = 1e6 + 1
        assert blooming._slope.py_func(saturated, 3, 4, 50.0, 1e6) == (0.0, 0.0, 0.0)
        dead[place] = 50.0
        assert blooming._slope.py_func(dead, 3, 4, 50.0, 1e6) == (0.0, 0.0, 0.0)
    dark = np.full((3, 3), 49.0)
    assert blooming._slope.py_func(dark, 1, 1, 50.0, 1e6) == (1.0, 0.0, 0.0)


def test_the_highest_cell_is_that_of_smoothed_votes():
    votes = np.zeros(12)
    assert blooming._highest(votes) == 0
    votes[[2, 8, 9]] = 5.0, 4.0, 3.0
    smooth = np.convolve(votes, [1, 2, 3, 2, 1], mode="same")
    assert blooming._highest(votes) == 2 + smooth[2:-2].argmax() == 8
    votes[:] = 0.0
    votes[0] = 5.0  # seen by the first cell that has two on either side
    assert blooming._highest(votes) == 2


def test_the_place_is_the_mean_of_what_is_near_on_both_sides():
    # place, weight, side; the last is further off than three pixels
    places = np.array([(10.0, 1.0, 1.0), (11.0, 3.0, -1.0), (10.5, 2.0, 1.0), (15.0, 9.0, 1.0)])
    place, apart = blooming._agreement(places, 4, 10.0)
    assert place == pytest.approx((10.0 + 33.0 + 21.0) / 6)
    assert apart == pytest.approx((10.0 + 21.0) / 3 - 11.0)
    assert math.isnan(blooming._agreement(places[[0, 2, 3]], 3, 10.0)[0])
    assert math.isnan(blooming._agreement(places[[1]], 1, 10.0)[0])


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


def test_votes_go_both_ways_along_the_gradient_and_count_one_over_the_radius():
    edges = np.array([(20.0, 9.0, 0.6, 0.8, 7.0)])
    votes = np.empty((30, 40))
    circles._vote(edges, 1, 5.0, 15.0, votes)
    expected = np.zeros_like(votes)
    for r in range(5, 16):
        for way in (-1, 1):
            a, b = math.floor(20 + way * r * 0.6 + 0.5), math.floor(9 + way * r * 0.8 + 0.5)
            if 0 <= a < 40 and 0 <= b < 30:
                expected[b, a] += 1 / r
    np.testing.assert_allclose(votes, expected)
    assert np.count_nonzero(votes) == 11 + 7  # nine rows up there is no more


def test_candidates_are_the_highest_sums_of_three_by_three():
    votes = np.zeros((12, 19))
    for (i, j), value in {(3, 4): 5.0, (8, 14): 9.0, (9, 3): 1.0}.items():
        votes[i - 1 : i + 2, j - 1 : j + 2] = 0.5
        votes[i, j] = value
    places = np.zeros((2, 3))
    sums = np.empty_like(votes)
    circles._candidates(votes, sums, places)
    expected = ndimage.uniform_filter(votes, 3, mode="constant") * 9
    np.testing.assert_allclose(sums[1:-1, 1:-1], expected[1:-1, 1:-1], atol=1e-12)
    assert sorted(places.tolist()) == [[9.0, 4.0, 3.0], [13.0, 14.0, 8.0]]
    votes[:, [0, -1]] = 50.0  # of the border itself there are no sums
    circles._candidates(votes, sums, places)
    rim = np.ones(sums.shape, dtype=bool)
    rim[1:-1, 1:-1] = False
    assert not sums[rim].any()


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_a_circle_s_radius_is_that_of_edges_all_around_it(way):
    turns = 2 * np.pi * (np.arange(64) + 0.5) / 64
    out = np.column_stack([np.cos(turns), np.sin(turns)])
    edges = np.column_stack([np.array([30.0, 20.0]) + 9.0 * out, way * out, np.full(64, 8.0)])
    room = np.empty((20, circles._SECTORS))
    edge, radius = circles._radius(edges, 64, 30.0, 20.0, way, 5.0, 15.0, 0.9, room)
    assert (edge, radius) == (8.0, pytest.approx(9.0, abs=1.0))
    # the other way round there is none, nor among other radii, nor of half a circle
    assert circles._radius(edges, 64, 30.0, 20.0, -way, 5.0, 15.0, 0.9, room) == (0.0, 0.0)
    assert circles._radius(edges, 64, 30.0, 20.0, way, 11.0, 15.0, 0.9, room) == (0.0, 0.0)
    assert circles._radius(edges[:32], 32, 30.0, 20.0, way, 5.0, 15.0, 0.9, room) == (0.0, 0.0)
    half = circles._radius(edges[:32], 32, 30.0, 20.0, way, 5.0, 15.0, 0.5, room)
    assert half[0] == pytest.approx(4.0)


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


def hole(pixels, start, most=99, shape=(7, 11)):
    image = np.full(shape, 9.0)
    for place in pixels:
        image[place] = 5.0  # not above a level of 5
    marks = np.zeros(image.size, dtype=np.int32)
    found = np.empty(image.size, dtype=np.int64)
    first = start[0] * shape[1] + start[1]
    count, enclosed = flood.py_func(image, first, 5.0, False, SIDES, most, 3, marks, found)
    return count if enclosed else 0, marks, found


def test_a_hole_is_what_hangs_together_side_by_side():
    pixels = [(2, 3), (2, 4), (3, 4), (4, 5), (3, 8)]  # the last two touch at a corner or not
    count, marks, found = hole(pixels, (2, 3))
    assert count == 3
    assert set(found[:3].tolist()) == {2 * 11 + 3, 2 * 11 + 4, 3 * 11 + 4}
    assert (marks == 3).sum() == 3
    assert holes._corner(marks, 3, found[:3], 11) == pytest.approx(
        # edges across at x = 2.5, 4.5 in the first row, 3.5 and 4.5 in the second
        ((2.5 + 4.5 + 3.5 + 4.5) / 4, (1.5 + 2.5 + 1.5 + 3.5) / 4)
    )


@pytest.mark.parametrize(
    ("path", "closed"),
    [
        ([(3, 3), (2, 3), (1, 3)], True),
        ([(3, 3), (2, 3), (1, 3), (0, 3)], False),
        ([(3, 3), (4, 3), (5, 3), (6, 3)], False),
        ([(3, 2), (3, 1)], True),
        ([(3, 2), (3, 1), (3, 0)], False),
        ([(3, 8), (3, 9)], True),
        ([(3, 8), (3, 9), (3, 10)], False),
    ],
)
def test_a_hole_that_reaches_the_edge_is_open(path, closed):
    for most in (99, 20):
        assert hole(path, path[0], most)[0] == (len(path) if closed else 0)


def test_a_hole_of_more_pixels_than_allowed_is_none():
    square = [(i, j) for i in range(2, 5) for j in range(3, 6)]
    assert hole(square, (2, 3), 9)[0] == 9
    assert hole(square, (2, 3), 8)[0] == 0


def test_a_round_hole_is_at_most_half_again_as_spread_as_a_disc():
    """A bar of n by 1: (n^2 - 1) / 12, and 1/6 for the pixels' own extent, against n / (2 pi)."""
    for length in range(2, 9):
        for step in (1, 11):
            pixels = 30 + step * np.arange(length)
            spread = ((length**2 - 1) / 12 + 1 / 6) / (length / (2 * math.pi))
            assert bool(holes._round(pixels, length, 11)) == (spread <= 1.5)


# First spikes


@pytest.mark.parametrize(
    ("changed", "count"),
    [
        ({}, 3),
        ({(0, 0): -0.001}, -1),
        ({(0, 0): 0.0, (0, 1): 0.0}, 3),
        ({(1, 1): 65535.9}, 3),
        ({(1, 1): 65536.0}, -1),
        ({(1, 0): 65536.0}, -1),
        ({(2, 2): np.inf}, -1),
        ({(2, 2): np.nan}, -1),
        ({(2, 2): -1.0}, 3),
        ({(2, 0): np.nan, (2, 1): np.nan, (2, 2): np.nan}, 2),
        ({(1, 0): np.nan, (1, 1): np.nan, (1, 2): np.nan}, -1),  # a gap before the last
    ],
)
def test_events_are_counted_up_to_the_last_and_broken_ones_told(changed, count):
    events = np.full((2, 5, 3), np.nan)
    events[:, :3] = [(4.0, 7.0, 60.0), (5.0, 8.0, 70.0), (6.0, 9.0, 80.0)]
    for (m, column), value in changed.items():
        events[1, m, column] = value
    assert spikes.count.py_func(events).tolist() == [3, count]


def test_light_is_the_inverse_of_times_but_for_hot_pixels():
    times = np.array([1.0, 50.0, 100.0, 0.0, 200.0, 100.0, -5.0])
    events = np.column_stack([np.zeros((7, 2)), times])
    out = np.empty(7)
    # lit: the fourth of five, at 3/4 of 1/200, 1/100, 1/100, 1/50, 1: 1/50
    assert spikes._weights.py_func(events, 7, 3.0, -1, out)
    np.testing.assert_allclose(out, [0.0, 0.02, 0.01, 0.0, 0.005, 0.01, 0.0])
    assert spikes._weights.py_func(events, 7, 50.0001, -1, out)
    assert out[0] == 1.0
    assert not spikes._weights.py_func(events[3:4], 1, 3.0, -1, out)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize(("width", "middle"), [(1, 20.0), (2, 20.5), (3, 20.0)])
def test_the_winner_is_the_middle_of_the_brightest_neighbours(axis, width, middle):
    places = np.array([0.0, 19.0, 20.0, 21.0, 40.0])
    weights = np.array([3.0, 2.0, 4.0, 3.0, 3.5])
    events = np.ones((5, 3))
    events[:, axis] = places
    assert spikes._winner.py_func(events, 5, axis, weights, width) == middle


def test_at_the_first_address_a_window_reaches_over_the_edge():
    events = np.zeros((1, 3))
    assert spikes._winner.py_func(events, 1, 0, np.ones(1), 1) == 0.0
    # of equal windows the first: what lies before the array is dark
    assert spikes._winner.py_func(events, 1, 0, np.ones(1), 3) == -1.0


def test_lines_move_by_their_own_events_and_share_what_is_near():
    centre, reach = (10.0, 20.0), 2.0
    events = np.array(
        [
            (12.0, 26.0, 1.0), (9.0, 40.0, 1.0),  # of the line along y, one as far as the reach
            (30.0, 21.0, 1.0), (40.0, 18.0, 1.0), (50.0, 22.0, 1.0),  # of that along x
            (11.0, 19.0, 1.0),  # of both
            (12.1, 30.0, 1.0), (30.0, 22.1, 1.0),  # of none
        ]
    )  # fmt: skip
    weights = np.array([1.0, 3.0, 2.0, 1.0, 1.0, 5.0, 4.0, 3.0])
    move_x, move_y, share = spikes._line_step.py_func(events, 8, weights, centre, reach)
    assert move_x == pytest.approx((2.0 * 1 - 1.0 * 3) / 4)
    assert move_y == pytest.approx((1.0 * 2 - 2.0 * 1 + 2.0 * 1) / 4)
    assert share == pytest.approx(13.0 / 20.0)
    alone = spikes._line_step.py_func(events[:2], 2, weights[:2], centre, reach)
    assert math.isnan(alone[0])
    assert alone[2] == 0.0
