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


@pytest.mark.parametrize(("frame", "place"), [((40, 100), (52.0, 18.0)), ((100, 90), (41.0, 71.0))])
def test_the_displacement_is_the_mean_of_the_matched(frame, place):
    rng = np.random.default_rng(3)
    off = rng.uniform(-0.3, 0.3, (4, 2))
    spots = np.column_stack([TABLE[:, :2] + place + off, np.ones(4)])
    order = np.array([2, 0, 3, 1])
    displacement, partners = matched(spots[order], frame)
    np.testing.assert_allclose(displacement, place + off.mean(axis=0), rtol=1e-12)
    assert partners == [1, 3, 0, 2]


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
