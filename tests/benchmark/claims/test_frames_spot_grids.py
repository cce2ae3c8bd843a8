"""Grids of the experiments: which spots are there, and where they fall."""

from __future__ import annotations

import numpy as np

from benchmark.claims.experiments.frames.spot_grids import (
    SIDE,
    grid_frames,
    grid_geometry,
    middles_px,
    offsets_px,
    present,
)


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
