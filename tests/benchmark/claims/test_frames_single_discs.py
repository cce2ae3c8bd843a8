"""Single discs of the experiments: noise, places, bound and errors are what they are said to be."""

from __future__ import annotations

import math

import numpy as np
import pytest

from algorithms.extractors.frames.centroid import BasicCentroid
from benchmark.claims.experiments.frames.c46_hough_circle import corrupt
from benchmark.claims.experiments.frames.single_discs import (
    RADIUS_PX,
    Spots,
    errors_px,
    single,
)
from benchmark.claims.experiments.frames.spot_grids import (
    SIDE,
    grid_frames,
    grid_geometry,
    middles_px,
    offsets_px,
    present,
)
from benchmark.synthetic_features.shapes import EDGE_PX


@pytest.fixture(scope="module")
def drawn() -> Spots:
    return single("test", 0, frames=20)


def test_first_moments_of_the_light_are_the_centres(drawn: Spots) -> None:
    y, x = np.indices(drawn.light.shape[1:])
    total = drawn.light.sum(axis=(1, 2))
    moments = [(drawn.light * axis).sum(axis=(1, 2)) / total for axis in (x, y)]
    np.testing.assert_allclose(np.column_stack(moments), drawn.centres, atol=1e-4)
    assert drawn.light.max() == pytest.approx(1.0, abs=1e-6)


def test_noise_is_its_share_of_the_peak_and_of_both_signs(drawn: Spots) -> None:
    noise = drawn.frames(0.2) - drawn.light
    assert float(noise.std()) == pytest.approx(0.2, rel=0.01)
    assert abs(float(noise.mean())) < 0.003


def test_no_digital_number_is_clipped_at_a_fifth_of_noise(drawn: Spots) -> None:
    numbers = drawn.digital(0.2).astype(np.float64).ravel()
    frames = drawn.frames(0.2).ravel()
    line = np.polyval(np.polyfit(frames, numbers, 1), frames)
    # nothing but rounding departs from a line
    assert float(np.abs(numbers - line).max()) < 0.51


def test_bound_is_that_of_a_blurred_edge_integrated_by_hand(drawn: Spots) -> None:
    # of a unit step blurred by the rim and by the pixel (variance 1/12), slope squared along the
    # edge: 1 / (2 sqrt(pi) s); of each bit of the rim half of it counts for x
    blur = math.sqrt(EDGE_PX**2 + 1.0 / 12.0)
    fisher = math.pi * RADIUS_PX / (2.0 * math.sqrt(math.pi) * blur)
    assert drawn.bound_px(0.05) == pytest.approx(0.05 / math.sqrt(fisher), rel=0.02)


def test_basic_centroids_error_is_that_of_summed_noise(drawn: Spots) -> None:
    many = single("test", 1)
    share = 0.02
    error = errors_px(many, {"bcm": BasicCentroid()}, (share,))["bcm"][0]
    size = many.light.shape[1]
    pixels = np.arange(size)
    lever = [np.mean((pixels - c) ** 2) * size**2 for c in many.centres.ravel()]
    wanted = share * math.sqrt(float(np.mean(lever))) / (math.pi * RADIUS_PX**2)
    assert error == pytest.approx(wanted, rel=0.1)


def test_two_thirds_of_the_corruption_are_lost_and_one_is_a_glint() -> None:
    many = single("test", 2)
    spoilt = corrupt(many, 0.2, np.random.default_rng(1))
    area = math.pi * RADIUS_PX**2
    inside = many.light > 0.5
    lost = np.where(inside, many.light - spoilt.light, 0.0).sum(axis=(1, 2)) / area
    # dead pixels are taken of what the gap has left
    assert float(lost.mean()) == pytest.approx(0.2 * 2.0 / 3.0, rel=0.1)
    glint = np.where(many.light < 1e-9, spoilt.light, 0.0).sum(axis=(1, 2)) / area
    assert 0.03 < float(glint.mean()) < 0.2 / 3.0 + 0.01
    np.testing.assert_array_equal(corrupt(many, 0.0, np.random.default_rng(1)).light, many.light)


def test_so_many_spots_are_missing_and_more_of_them_with_a_larger_share() -> None:
    few, many = (present("test", 0, 5, share) for share in (0.3, 0.5))
    assert (few.sum(axis=1) == 70).all()
    assert (many.sum(axis=1) == 50).all()
    assert (many <= few).all()
    assert not (few[0] == few[1]).all()


def test_spots_fall_about_the_middle_and_missing_ones_do_not() -> None:
    middles, there = middles_px("test", 0, 3), present("test", 0, 3, 0.3)
    frames = grid_frames("test", 0, middles, there).astype(np.float64)
    floor = np.median(frames)
    pixels = np.indices(frames.shape[1:])
    y, x = pixels[0], pixels[1]
    for frame, middle, lit in zip(frames, middles, there, strict=True):
        for spot, here in zip(middle + offsets_px(SIDE), lit, strict=True):
            near = np.hypot(x - spot[0], y - spot[1]) < 7.0
            light = (frame - floor)[near]
            assert (light.sum() > 1e4) == bool(here)
            if here:
                centroid = [(light * axis[near]).sum() / light.sum() for axis in (x, y)]
                np.testing.assert_allclose(centroid, spot, atol=0.15)


def test_the_design_names_the_apertures_that_cast_the_spots() -> None:
    design = grid_geometry(3)
    assert design.apertures is not None
    assert design.pixel_pitch_mm is not None
    places = np.array(design.apertures)[:, :2] / design.pixel_pitch_mm
    np.testing.assert_allclose(places, offsets_px(3), atol=1e-9)
