"""ESCM and its winners against the printed mean, closed forms and scattered events."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.contract import SensorGeometry
from algorithms.extractors.events.centroid import EventCentroid, EventWinner

LINES = EventCentroid(width_px=3.0)
SPOT = EventCentroid(width_px=5.0, layout="spot")
L_SLIT = SensorGeometry(
    pixel_pitch_mm=0.05, line_axes=("x", "y"), slits=((-0.5, 0.0, 0.15),), focal_length_mm=1.0
)


def cover(size, centre, width):
    """Share of each pixel that a band covers."""
    edges = np.arange(size)[:, None] + [-0.5, 0.5]
    inside = np.clip(edges, centre - width / 2, centre + width / 2)
    return inside[:, 1] - inside[:, 0]


def events_of(light, most=2000, jitter=0.0, seed=0):
    """First spikes (1, M, 3) of pixels in `light` (H, W): 100 us in full light."""
    rng = np.random.default_rng(seed)
    y, x = np.nonzero(light > 1e-3)
    t = 100.0 / light[y, x] * (1 + jitter * rng.standard_normal(len(y)))
    order = np.argsort(t, kind="stable")[:most]
    events = np.full((1, most, 3), np.nan)
    events[0, : len(order)] = np.column_stack([x, y, t])[order]
    return events


def an_l(x, y, size=40, width=3.0):
    """Light of an L: a line along y from y on and one along x from x on."""
    across_x, across_y = cover(size, x, width), cover(size, y, width)
    beyond_x = cover(size, size / 2 + x - width / 2, size)  # from the other line's outer edge
    beyond_y = cover(size, size / 2 + y - width / 2, size)
    return np.maximum(across_x[None, :] * beyond_y[:, None], across_y[:, None] * beyond_x[None, :])


inside = st.floats(5.0, 22.0)


@settings(deadline=None, derandomize=True, max_examples=50)
@given(inside, inside)
def test_the_mean_of_an_l_without_noise_is_where_its_lines_are(x, y):
    """All pixels fire: the weights are the light, whose mean across a line is its middle."""
    found = LINES.extract(events_of(an_l(x, y)))
    np.testing.assert_allclose(found, [[x, y]], atol=0.01)  # 0.01: what fires too late is left out


@settings(deadline=None, derandomize=True, max_examples=50)
@given(inside, inside, st.integers(0, 9))
def test_the_mean_is_the_printed_sum(x, y, seed):
    """alg:ECM over the events of each line away from the other, as brute force selects them."""
    events = events_of(an_l(x, y), jitter=0.02, seed=seed)
    found = LINES.extract(events)[0]
    column, row, t = events[0][np.isfinite(events[0, :, 2])].T
    near_x, near_y = np.abs(column - found[0]) <= 3.0, np.abs(row - found[1]) <= 3.0
    for axis, (value, mine) in enumerate(((column, near_x & ~near_y), (row, near_y & ~near_x))):
        printed = np.sum(value[mine] / t[mine]) / np.sum(1 / t[mine])
        assert abs(found[axis] - printed) < 1e-8


@settings(deadline=None, derandomize=True, max_examples=50)
@given(inside, inside)
def test_a_spot_is_the_printed_sum_over_all_its_events(x, y):
    light = np.outer(cover(40, y, 5.0), cover(40, x, 5.0))
    events = events_of(light)
    column, row, t = events[0][np.isfinite(events[0, :, 2])].T
    printed = np.array([np.sum(v / t) / np.sum(1 / t) for v in (column, row)])
    np.testing.assert_allclose(SPOT.extract(events)[0], printed, atol=1e-9)
    np.testing.assert_allclose(SPOT.extract(events), [[x, y]], atol=0.01)


def test_hot_pixels_do_not_move_a_line():
    clean = events_of(an_l(12.3, 14.6), jitter=0.01)
    hot = clean.copy()
    spikes = [(3, 30, 0.1), (12, 35, 0.4), (30, 2, 1.0), (35, 14, 20.0)]
    hot[0, len(spikes) :] = clean[0, : -len(spikes)]
    hot[0, : len(spikes)] = spikes
    np.testing.assert_allclose(LINES.extract(hot), LINES.extract(clean), atol=0.02)


@pytest.mark.parametrize("width", [1.5, 2.3, 3.0, 4.0, 7.0])
def test_no_pixel_of_a_spot_is_taken_for_a_hot_one(width):
    """However small, wherever it falls and with dim pixels around: the mean of all its events."""
    rng = np.random.default_rng(7)
    fine = (np.arange(20 * 16) + 0.5) / 16 - 0.5
    for place in rng.uniform(9.5, 10.5, (40, 2)):
        inside = np.hypot(fine - place[0], (fine - place[1])[:, None]) <= 0.5 * width
        light = 0.01 + inside.reshape(20, 16, 20, 16).mean(axis=(1, 3))
        times = 100 / light * (1 + 0.02 * rng.standard_normal(light.shape))
        rows, columns = np.unravel_index(np.argsort(times, axis=None)[:40], times.shape)
        events = np.column_stack([columns, rows, times[rows, columns]])[None]
        kept, everything = (
            EventCentroid(width_px=width, layout="spot", hot=hot).extract(events)
            for hot in (2.0, np.inf)
        )
        np.testing.assert_array_equal(kept, everything)


@pytest.mark.parametrize("width", [2.5, 4.0, 7.0])
def test_a_hot_pixel_does_not_move_a_spot(width):
    light = np.outer(cover(20, 10.2, width), cover(20, 9.7, width))
    clean = events_of(light)
    hot = np.concatenate([[[[2.0, 15.0, 0.3]]], clean], axis=1)
    method = EventCentroid(width_px=width, layout="spot")
    np.testing.assert_allclose(method.extract(hot), method.extract(clean), atol=1e-9)


@pytest.mark.parametrize("width", [4.0, 7.0])
def test_two_hot_pixels_do_not_move_a_spot_that_lights_many(width):
    """What light a lit pixel has, more pixels tell than two are."""
    light = np.outer(cover(20, 10.2, width), cover(20, 9.7, width))
    clean = events_of(light)
    hot = np.concatenate([[[[2.0, 15.0, 0.3], [3.0, 2.0, 0.3]]], clean], axis=1)
    method = EventCentroid(width_px=width, layout="spot")
    np.testing.assert_allclose(method.extract(hot), method.extract(clean), atol=1e-9)


def test_the_offset_of_the_slits_is_taken_off():
    method = EventCentroid.for_sensor(L_SLIT)
    assert method.width_px == pytest.approx(3.0)
    assert method.offset_px == pytest.approx(-10.0)
    events = events_of(an_l(12.0, 14.0))
    np.testing.assert_allclose(method.extract(events), [[22.0, 24.0]], atol=0.01)


def test_winners_are_whole_pixels_of_the_line():
    method = EventWinner.for_sensor(L_SLIT)
    assert method.winners == 8
    events = events_of(an_l(12.2, 14.4), jitter=0.02)
    found = method.extract(events) + method.offset_px
    assert (found == found.round()).all()
    np.testing.assert_allclose(found, [[12.2, 14.4]], atol=1.6)  # anywhere on a line 3 px wide


def test_the_mean_is_ten_times_finer_than_the_winners():
    places = np.random.default_rng(3).uniform(6, 20, (40, 2))
    mean, winner = [], []
    for n, (x, y) in enumerate(places):
        events = events_of(an_l(x, y), jitter=0.02, seed=n)
        mean.append(LINES.extract(events)[0])
        winner.append(EventWinner().extract(events)[0])
    rms = [np.sqrt(np.mean((np.array(found) - places) ** 2)) for found in (mean, winner)]
    assert rms[0] < 0.1 * rms[1]


def test_scattered_events_one_line_and_broken_events_are_not_found():
    rng = np.random.default_rng(5)
    scattered = np.column_stack([rng.integers(0, 64, (300, 2)), np.sort(rng.uniform(50, 90, 300))])
    line = events_of(np.outer(np.ones(40), cover(40, 12.0, 3.0)))
    good = events_of(an_l(12.0, 14.0))
    negative, gap, infinite = good.copy(), good.copy(), good.copy()
    negative[0, 5, 0] = -1.0
    gap[0, 5] = np.nan  # events after the last one
    infinite[0, 5, 2] = np.inf
    for events in (scattered[None], line, negative, gap, infinite, np.full((1, 4, 3), np.nan)):
        assert np.isnan(LINES.extract(events)).all()
    for events in (negative, gap, infinite, np.full((1, 4, 3), np.nan)):
        assert np.isnan(EventWinner().extract(events)).all()
        assert np.isnan(SPOT.extract(events)).all()


def test_events_must_have_three_columns():
    for method in (LINES, EventWinner()):
        with pytest.raises(ValueError, match=r"\(N, M, 3\).*got"):
            method.extract(np.ones((2, 5, 4)))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"slits": ((0.0, 10.0, 0.1),)}, "slant"),
        ({"slits": ((0.0, 0.0, 0.1), (1.0, 0.0, 0.1))}, "2 slits"),
        ({"line_axes": ("x",)}, "along"),
        ({"slits": None}, "neither"),
    ],
)
def test_other_designs_are_refused(change, said):
    for method in (EventCentroid, EventWinner):
        with pytest.raises(ValueError, match=said):
            method.for_sensor(replace(L_SLIT, **change))
