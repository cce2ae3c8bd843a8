"""Frames drawn afresh: what the sets hold, and that a seed settles them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmark.synthetic_features.frame_sets import FRAME_SETS
from benchmark.synthetic_features.frames import REFERENCE_SETS
from benchmark.synthetic_features.shapes import (
    EDGE_PX,
    disc,
    gaussian,
    limb_darkened,
    render,
    square,
    stretch,
)

SETS = {chosen.name: chosen for chosen in FRAME_SETS}
SMALL = [chosen for chosen in FRAME_SETS if chosen.size_px == 64]


@pytest.mark.parametrize(
    ("shape", "light"),
    [
        (disc(8.0), math.pi * (8.0**2 + EDGE_PX**2)),
        (gaussian(3.0), 2.0 * math.pi * 3.0**2),
        (stretch(8.0, 60.0), 2.0 * math.pi * 8.0**2),
        (square(8.0), 16.0**2),
        # a wide one: its law is steep where the rim is
        (limb_darkened(24.0), (1.0 - 0.6 / 3.0) * math.pi * 24.0**2),
    ],
)
def test_shapes_hold_the_light_of_their_area(shape, light):
    found = render(shape, np.array([[31.3, 30.8]]), np.array([0.4]), 64)
    assert found.sum() == pytest.approx(light, rel=0.01)


@pytest.mark.parametrize(
    "chosen", [one for one in SMALL if one.kind == "symmetric"], ids=lambda one: one.name
)
def test_symmetric_spots_have_their_centroid_at_the_centre(chosen):
    centres = np.array([[31.37, 30.82], [32.0, 31.5]])
    frames = render(chosen.shape, centres, np.array([0.3, 1.1]) * chosen.turned, 64)
    total = frames.sum(axis=(1, 2))
    x = (frames.sum(axis=1) @ np.arange(64)) / total
    y = (frames.sum(axis=2) @ np.arange(64)) / total
    # an Airy pattern's rings are cut by the frame
    far = 0.1 if chosen.name == "airy" else 1e-3
    np.testing.assert_allclose(np.column_stack([x, y]), centres, atol=far)


@pytest.mark.parametrize("chosen", [SETS["glare"], SETS["5 dead"]])
def test_a_seed_settles_the_frames_and_their_number_does_not(chosen):
    first = chosen.draw(7, 3)
    again = chosen.draw(7, 30)
    np.testing.assert_array_equal(first.frames, again.frames[:3])
    np.testing.assert_array_equal(first.centres, again.centres[:3])
    assert first.bound_px == again.bound_px
    assert (chosen.draw(8, 3).frames != first.frames).any()


def test_the_bound_is_that_of_the_reference_set():
    """By other code, with centres at other phases."""
    reference = REFERENCE_SETS["disc"]
    expected = reference.bound_px(reference.centres(24))
    assert SETS["disc"].draw(1, 1).bound_px == pytest.approx(expected, rel=0.02)


def test_broken_pixels_are_as_many_as_the_name_says():
    hot, dead = SETS["5 hot"].draw(3, 6), SETS["5 dead"].draw(3, 6)
    assert ((hot.frames == 4095).sum(axis=(1, 2)) == 5).all()
    y, x = np.indices((64, 64))
    for frame, centre in zip(dead.frames, dead.centres, strict=True):
        assert (frame[np.hypot(x - centre[0], y - centre[1]) < 6.0] == 0).sum() <= 5
        assert (frame[np.hypot(x - centre[0], y - centre[1]) < 8.0] == 0).sum() == 5


def test_without_the_sun_there_is_neither_a_place_nor_a_bound():
    for name, brightest in (("no Sun", 100), ("no Sun, 1 hot", 4095)):
        scenes = SETS[name].draw(4, 5)
        assert np.isnan(scenes.centres).all()
        assert math.isnan(scenes.bound_px)
        assert (scenes.frames.max(axis=(1, 2)) <= brightest).all()
    assert (np.sort(scenes.frames.reshape(5, -1))[:, -2] < 100).all()


@pytest.mark.parametrize(("name", "share"), [("ghost apart", 0.5), ("two apart", 1.0)])
def test_a_second_light_is_where_and_as_bright_as_it_should_be(name, share):
    chosen = SETS[name]
    centres, other = chosen.scenery(np.random.default_rng(5), 20, chosen)
    total = other.sum(axis=(1, 2))
    np.testing.assert_allclose(
        total, share * chosen.peak_e * math.pi * (8.0**2 + EDGE_PX**2), rtol=0.01
    )
    x, y = other.sum(axis=1) @ np.arange(64) / total, other.sum(axis=2) @ np.arange(64) / total
    apart = np.hypot(*(np.column_stack([x, y]) - centres).T)
    assert apart.min() > 17.9
    assert apart.max() < 24.1
