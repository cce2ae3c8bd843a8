"""What extractors refuse: parameters, designs, light; and lists and cameras at their limits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from algorithms.contract import SensorGeometry, UnsuitableDesignError
from algorithms.extractors.frames.multi_spot.multiple_centroids import MultipleCentroids
from algorithms.extractors.frames.multi_spot.spot_list import SpotList
from algorithms.extractors.frames.multi_spot.weighted_spots import WeightedSpots
from algorithms.extractors.profiles.centroid import ProfileCentroid

HOLE = ((0.0, 0.0, 5.0),)


@pytest.mark.parametrize(
    "without",
    [{"slits": ()}, {"line_axes": ()}, {"line_pixels": 0}, {"focal_length_mm": 0.0}],
)
def test_a_design_with_no_line_behind_a_slit_is_refused(without: dict[str, Any]) -> None:
    design: dict[str, Any] = {
        "focal_length_mm": 2.0,
        "pixel_pitch_mm": 0.05,
        "half_fov_deg": 30.0,
        "line_axes": ("x", "y"),
        "line_pixels": 64,
        "slits": ((0.0, 0.0, 0.3),),
    }
    assert ProfileCentroid.for_sensor(SensorGeometry(**design)).line_pixels == 64
    with pytest.raises(UnsuitableDesignError, match="needs lines of pixels behind slits"):
        ProfileCentroid.for_sensor(SensorGeometry(**{**design, **without}))


def test_of_more_spots_than_a_list_has_the_brightest_are_kept_in_the_order_of_reading() -> None:
    frame = np.zeros((1, 60, 80))
    places = {(10, 10): 300.0, (60, 20): 200.0, (30, 30): 250.0, (50, 45): 400.0}
    for (left, top), light in places.items():
        frame[0, top : top + 5, left : left + 5] = light
    frame.setflags(write=False)
    every = SpotList(HOLE, spots=4).extract(frame).reshape(4, 3)
    assert every[:, 0].tolist() == [12.0, 62.0, 32.0, 52.0]
    brightest = SpotList(HOLE, spots=2).extract(frame).reshape(2, 3)
    np.testing.assert_array_equal(brightest, every[[0, 3]])


def test_spots_one_pixel_thick_have_no_profile_to_be_weighted_by() -> None:
    holes = ((-10.0, -8.0, 3.0), (10.0, -8.0, 3.0), (0.0, 10.0, 3.0), (12.0, 9.0, 3.0))
    frames = np.full((2, 64, 64), 5.0)
    for x, y in np.array(holes, dtype=int)[:, :2] + 31:
        frames[0, y, x - 2 : x + 3] = 500.0
        frames[1, y - 1 : y + 2, x - 1 : x + 2] = 500.0
    frames.setflags(write=False)
    found = MultipleCentroids(holes, blur_px=1.0).extract(frames)
    np.testing.assert_allclose(found, [[31.0, 31.0]] * 2, atol=1e-9)
    weighted = WeightedSpots(holes, blur_px=1.0).extract(frames)
    np.testing.assert_allclose(weighted, [[np.nan, np.nan], [31.0, 31.0]], atol=1e-9)
