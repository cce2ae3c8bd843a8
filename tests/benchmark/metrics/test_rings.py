"""Error by off-axis angle: the right ring, enough samples, and fields weighted by solid angle."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from benchmark.metrics.rings import EDGES_DEG, RINGS, field_error, ring_errors, widest_field
from benchmark.metrics.score import score

NAMES = {(ring.inner_deg, ring.outer_deg): place for place, ring in enumerate(RINGS)}


def suns(off_axis_deg, around=0.7):
    off = np.deg2rad(np.asarray(off_axis_deg, dtype=float))
    return np.stack([np.sin(off) * np.cos(around), np.sin(off) * np.sin(around), np.cos(off)], 1)


def judged(off_axis_deg, error_deg=1.0, answered=True):
    count = len(off_axis_deg)
    return ring_errors(
        suns(off_axis_deg),
        np.broadcast_to(answered, count),
        np.broadcast_to(np.asarray(error_deg, dtype=float), count),
    )


def row_of(*errors):
    return {
        ring.column: error for ring, error in zip(RINGS, [*errors, *[None] * 9][:9], strict=True)
    }


def test_rings_cover_the_sphere_once():
    assert [(ring.inner_deg, ring.outer_deg) for ring in RINGS] == list(pairwise(EDGES_DEG))
    assert (EDGES_DEG[0], EDGES_DEG[-1]) == (0, 180)
    assert sum(ring.solid_angle for ring in RINGS) == pytest.approx(1.0)


@settings(deadline=None, derandomize=True)
@given(off=st.floats(0.0, 180.0), around=st.floats(0.0, 6.28))
def test_a_sample_falls_in_the_ring_between_whose_edges_it_lies(off, around):
    # at an edge the rounding of a cosine decides
    assume(min(abs(off - edge) for edge in EDGES_DEG[1:]) > 1e-5)
    found = ring_errors(suns([off] * 5, around), np.ones(5, bool), np.full(5, 0.25))
    inside = [inner <= off <= outer for inner, outer in pairwise(EDGES_DEG)]
    assert inside.count(True) == 1
    assert [value == 0.25 for value in found] == inside
    assert [math.isnan(value) for value in found] == [not one for one in inside]


def test_the_boresight_is_in_the_first_ring_and_what_lies_behind_in_the_last():
    boresight, behind = np.tile([0.0, 0.0, 1.0], (5, 1)), np.tile([0.0, 0.0, -1.0], (5, 1))
    for sun, place in ((boresight, 0), (behind, -1)):
        assert ring_errors(sun, np.ones(5, bool), np.full(5, 2.0))[place] == 2.0


def test_the_error_of_a_ring_is_the_root_mean_square_over_its_answers():
    off = [5.0] * 25 + [15.0] * 30
    error = np.arange(55.0)
    answered = np.arange(55) != 3  # one of 25: 96 %
    first, second, *_ = judged(off, error, answered)
    assert first == pytest.approx(np.sqrt(np.mean(np.delete(error[:25], 3) ** 2)))
    assert second == pytest.approx(np.sqrt(np.mean(error[25:] ** 2)))


@pytest.mark.parametrize(("count", "said"), [(4, False), (5, True)])
def test_fewer_than_five_samples_say_nothing(count, said):
    found = judged([35.0] * count)[NAMES[30, 40]]
    assert (not math.isnan(found)) is said


@pytest.mark.parametrize(("silent", "said"), [(0, True), (1, True), (2, False), (20, False)])
def test_a_ring_needs_95_percent_of_answers(silent, said):
    """Of twenty samples one may be without an answer, not two: NaN, never a flattering error."""
    found = judged([35.0] * 20, answered=np.arange(20) >= silent)[NAMES[30, 40]]
    assert (not math.isnan(found)) is said


def test_only_observable_samples_enter_a_score():
    """Half of a ring is dark and answered wildly: neither its error nor its share of answers."""
    sun = suns([5.0] * 20)
    predicted, seen = sun.copy(), np.arange(20) < 10
    predicted[~seen] = [1.0, 0.0, 0.0]
    assert score(predicted, sun, None, seen).row()["rms_0_10_deg"] == 0.0
    predicted[~seen] = np.nan
    assert score(predicted, sun, None, seen).row()["rms_0_10_deg"] == 0.0
    predicted[:10] = np.nan
    predicted[10:] = sun[10:]
    assert score(predicted, sun, None, seen).row()["rms_0_10_deg"] is None


@settings(deadline=None, derandomize=True)
@given(
    errors=st.lists(st.floats(0.001, 100.0), min_size=9, max_size=9),
    edge=st.sampled_from(EDGES_DEG[1:]),
)
def test_the_error_over_a_field_weights_rings_by_their_solid_angle(errors, edge):
    """Against an integral over the cone, in steps of a hundredth of a degree."""
    step = 0.01
    angle = np.arange(step / 2, edge, step)
    ring = np.searchsorted(EDGES_DEG, angle) - 1
    weight = np.sin(np.deg2rad(angle))
    squares = np.array(errors)[ring] ** 2
    expected = math.sqrt(np.sum(squares * weight) / np.sum(weight))
    assert field_error(row_of(*errors), edge) == pytest.approx(expected, rel=1e-5)


def test_how_samples_are_spread_over_the_field_does_not_matter():
    """Two data sets of the same sensor, one crowded at the centre, one at the rim."""
    fields = []
    for counts in ((500, 10, 10), (10, 10, 500)):
        off = np.repeat([5.0, 15.0, 25.0], counts)
        found = judged(off, error_deg=np.repeat([1.0, 2.0, 4.0], counts))
        fields.append(field_error(row_of(*found[:3]), 30))
    assert fields[0] == pytest.approx(fields[1])
    assert 1.0 < fields[0] < 4.0


def test_a_field_with_a_ring_that_says_nothing_has_no_error():
    row = row_of(0.1, None, 0.1)
    assert field_error(row, 10) == pytest.approx(0.1)
    assert field_error(row, 20) is None
    assert field_error(row, 30) is None


@pytest.mark.parametrize("angle", [0, 15, 45, 181, -10])
def test_an_angle_that_is_no_edge_is_refused_with_the_edges(angle):
    edges = ", ".join(f"{edge:g}" for edge in EDGES_DEG[1:])
    with pytest.raises(ValueError, match=rf"\b{edges}\b.* {angle}$"):
        field_error(row_of(*[0.1] * 9), angle)


@pytest.mark.parametrize(
    ("errors", "widest"),
    [
        ((0.1, 0.2, 0.3, 0.4), 30),
        ((0.1, 0.4, 0.1), 10),  # a better ring further out does not make up for it
        ((0.1, None, 0.1), 10),
        ((0.31,), None),
        ((None, 0.1), None),
        ((0.3,) * 9, 180),
    ],
)
def test_the_widest_field_ends_at_the_first_ring_beyond_the_limit(errors, widest):
    assert widest_field(row_of(*errors), 0.3) == widest
