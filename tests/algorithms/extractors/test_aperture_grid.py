"""Matching spots to apertures, part by part, in frames wider than high and the other way round."""

import numpy as np
import pytest

from algorithms.extractors.frames.multi_spot import aperture_grid_kernel as kernel
from algorithms.extractors.frames.multi_spot import evidence_kernel as evidence
from algorithms.extractors.frames.multi_spot import view_kernel as view
from algorithms.extractors.frames.multi_spot.aperture_pattern import lattice
from algorithms.extractors.frames.multi_spot.records import Matches, Seen, Views

#: Asymmetric, so that no turn, mirror or shift of it is itself.
APERTURES = ((-30.0, -8.0, 6.0), (-9.0, 7.0, 6.0), (4.0, -6.0, 8.0), (22.0, 9.0, 6.0))
TABLE = np.array(APERTURES)


@pytest.mark.parametrize(
    ("x", "y", "seen"),
    [
        # half a width of 6, a margin of 1.5: whole from 4.5 to 99 - 4.5 and to 39 - 4.5
        (4.5, 20.0, True),
        (4.49, 20.0, False),
        (94.49, 20.0, True),
        (94.5, 20.0, False),
        (50.0, 4.5, True),
        (50.0, 4.49, False),
        (50.0, 34.49, True),
        (50.0, 34.5, False),
    ],
)
def test_a_spot_is_expected_where_it_is_whole_in_the_frame(x, y, seen):
    one, none = np.array([[0.0, 0.0, 6.0]]), np.array([-1], dtype=np.int32)
    state = np.empty(1, dtype=np.int8)
    for shape, place in (((40, 100), (x, y)), ((100, 40), (y, x))):
        dark = np.zeros(shape)
        seen_here = view._look.py_func(dark, 1.0, one, 1.5, *place, np.empty((0, 4)), none, state)
        assert seen_here == (0, int(seen))


def test_the_nearest_aperture_is_that_of_all():
    known = lattice(APERTURES)
    rng = np.random.default_rng(1)
    met = set()
    for x, y in rng.uniform((-45, -20), (40, 22), (400, 2)):
        away = (TABLE[:, 0] - x) ** 2 + (TABLE[:, 1] - y) ** 2
        for reach in (3.0, 9.0):
            a, squared = kernel.nearest_aperture(known, x, y, reach)
            if away.min() < reach**2:
                assert a == away.argmin()
                assert squared == pytest.approx(away.min())
                met.add(int(a))
            else:
                assert a == -1
    assert met == {0, 1, 2, 3}


def test_votes_are_for_the_displacement_of_each_pair():
    spots = np.array([[10.0, 30.0, 1.0], [70.0, 5.0, 1.0]])
    cell = 2.0
    ballot = np.zeros((60, 90), dtype=np.int16)
    touched = np.empty(8, dtype=np.int64)
    cells = kernel._cast.py_func(spots, TABLE, cell, ballot, touched)
    expected = np.zeros_like(ballot)
    for x, y, _ in spots:
        for dx, dy, _ in APERTURES:
            expected[int((y - dy + 9.0) / cell) + 1, int((x - dx + 22.0) / cell) + 1] += 1
    np.testing.assert_array_equal(ballot, expected)
    assert set(touched[:cells]) == set(np.flatnonzero(expected))
    assert cells == np.count_nonzero(expected)


def test_a_peak_has_no_better_neighbour_and_none_before_it_as_good():
    rng = np.random.default_rng(2)
    ballot = np.zeros((12, 17), dtype=np.int16)
    ballot[1:-1, 1:-1] = rng.integers(0, 3, (10, 15))
    for i in range(1, 11):
        for j in range(1, 16):
            block = ballot[i - 1 : i + 2, j - 1 : j + 2].ravel()
            at = i * 17 + j
            assert kernel._around(ballot, at) == block.sum()
            best = block[4] > block[:4].max() and block[4] >= block[5:].max()
            assert bool(kernel._is_peak(ballot, at)) == best


def test_candidates_are_the_peaks_with_most_votes_around_them_a_third_of_the_most_at_least():
    ballot = np.zeros((30, 41), dtype=np.int16)
    peaks = {(5, 5): 9, (5, 20): 3, (20, 9): 2, (12, 33): 6, (24, 24): 4}
    for place, votes in peaks.items():
        ballot[place] = votes
    touched = np.array([i * 41 + j for i, j in peaks], dtype=np.int64)
    room = np.empty(touched.size, dtype=np.int16)
    best, votes = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    assert kernel._rank(ballot, touched, room, best, votes) == 3
    assert votes.tolist() == [9, 6, 4]
    assert best.tolist() == [5 * 41 + 5, 12 * 41 + 33, 24 * 41 + 24]
    best, votes = np.empty(9, dtype=np.int64), np.empty(9, dtype=np.int64)
    assert kernel._rank(ballot, touched, room, best, votes) == 4  # 3 is a third of 9, 2 is less
    assert votes[:4].tolist() == [9, 6, 4, 3]


def matched(spots, shape, tolerance=1.0, share=0.3):
    """Displacement and partners of spots (x, y), each of them 3 x 3 lit pixels."""
    known = lattice(APERTURES)
    frame = np.zeros((1, *shape))
    listed = np.array([(x, y, 9.0, 9.0) for x, y, *_ in spots])[None]
    for x, y, *_ in spots:
        frame[0, round(y) - 1 : round(y) + 2, round(x) - 1 : round(x) + 2] = 2.0
    none = np.zeros(1, dtype=np.int64)
    seen = Seen(listed, np.array([len(spots)]), np.empty((1, 4, 3)), none)
    all_of = 1, 24, len(APERTURES)
    matches = Matches(np.empty((1, 24, 2)), np.empty(all_of, dtype=np.int32), none.copy())
    kernel.match(seen, known, shape, tolerance, 4.0, matches)
    views = Views(
        np.empty(all_of, dtype=np.int8),
        np.empty((1, 24, 4), dtype=np.int32),
        np.empty((1, len(spots)), dtype=np.bool_),
        np.empty((1, 24), dtype=np.bool_),
    )
    view.look(frame, np.ones(1), seen, known.apertures, 1.0, share, matches, views)
    displacement = np.empty((1, 2))
    partners = np.empty((1, len(APERTURES)), dtype=np.int64)
    evidence.decide(
        seen,
        known,
        tolerance,
        (0.0, 0.0),
        (0.0, 0.0, np.inf),
        matches,
        views,
        displacement,
        partners,
        np.empty(1, dtype=np.int64),
    )
    return displacement[0], partners[0].tolist()


@pytest.mark.compiles
@pytest.mark.parametrize(("frame", "place"), [((40, 100), (52.0, 18.0)), ((100, 90), (41.0, 71.0))])
def test_the_displacement_is_the_mean_of_the_matched(frame, place):
    rng = np.random.default_rng(3)
    off = rng.uniform(-0.3, 0.3, (4, 2))
    spots = np.column_stack([TABLE[:, :2] + place + off, np.ones(4)])
    order = np.array([2, 0, 3, 1])
    displacement, partners = matched(spots[order], frame)
    np.testing.assert_allclose(displacement, place + off.mean(axis=0), rtol=1e-12)
    assert partners == [1, 3, 0, 2]


def test_a_start_one_and_a_half_tolerances_off_is_left_for_the_mean_of_the_spots():
    """The first round reaches two tolerances, and the rounds after it one from the mean."""
    tolerance, start, place = 1.0, np.array([51.1, 18.9]), np.array([52.3, 18.0])
    spots = np.column_stack([TABLE[:, :2] + place, np.ones((4, 2))])
    partner, distance = np.empty(4, dtype=np.int64), np.empty(4)
    met = np.empty(4, dtype=np.int64)
    x, y, quality, number = kernel._fit(
        spots, lattice(APERTURES), *start, tolerance, partner, distance, met
    )
    np.testing.assert_allclose((x, y), place, rtol=1e-12)
    assert partner.tolist() == [0, 1, 2, 3]
    assert number == 4
    assert quality == pytest.approx(4.0)


def test_what_lies_outside_a_frame_wider_than_high_is_not_missed():
    """Two of four apertures are off the frame to the right: those two are no gaps."""
    place = np.array([87.0, 15.0])
    spots = [(*(TABLE[a, :2] + place), 1.0) for a in (0, 1)]
    displacement, partners = matched(spots, (32, 90), share=0.9)
    np.testing.assert_allclose(displacement, place, atol=1e-9)
    assert partners == [0, 1, -1, -1]
    # in a frame so wide that they would be seen, two of four are too few
    displacement, partners = matched(spots, (32, 140), share=0.9)
    assert np.isnan(displacement).all()
    assert partners == [-1, -1, -1, -1]


def test_a_spot_as_far_as_the_tolerance_is_another():
    place = np.array([52.0, 18.0])
    for off, found in ((0.95, True), (2.4, False)):
        spots = np.column_stack([TABLE[:, :2] + place, np.ones(4)])
        spots[3, 0] += off * 4 / 3  # the mean follows by a fourth of it
        _, partners = matched(spots, (40, 100))
        assert (partners[3] == 3) is found
        assert partners[:3] == [0, 1, 2]


def test_too_few_spots_are_no_displacement():
    displacement, partners = matched([(50.0, 20.0)], (40, 100), share=1.1)
    assert np.isnan(displacement).all()
    assert partners == [-1] * 4
