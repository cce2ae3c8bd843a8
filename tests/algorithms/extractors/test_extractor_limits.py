"""Where extractors begin and end: faint light, the far side of wide frames, published defaults."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.contract import SensorGeometry
from algorithms.extractors.frames.multi_spot.aperture_design import design_pattern
from algorithms.extractors.frames.multi_spot.spot_list import SpotList
from algorithms.extractors.profiles.linear_phase import FrameLinearPhase
from algorithms.extractors.profiles.peak_detection import FramePeak


def test_the_peak_of_a_frame_may_be_of_any_brightness_above_zero():
    frame = np.zeros((7, 11))
    frame[4, 8] = 1.0
    for gain in (1e-6, 0.5, 1.0, 1e6):
        assert FramePeak().extract(gain * frame[None]).tolist() == [[8.0, 4.0]]
    assert np.isnan(FramePeak().extract(-frame[None])).all()


@pytest.mark.parametrize("blurred", [False, True])
@pytest.mark.parametrize("place", [(20.0, 14.0), (27.5, 14.0), (20.0, 17.5), (31.5, 12.5)])
def test_the_phase_of_a_symmetric_spot_is_that_of_its_place(place, blurred):
    """On whole and half pixels its light is as symmetric as it: the place is exact."""
    y, x = np.mgrid[:32, :50]
    lit = [np.clip(4.5 - abs(axis - at), 0, 1) for axis, at in zip((x, y), place, strict=True)]
    if blurred:
        lit = [np.exp(-((axis - at) ** 2) / 3) for axis, at in zip((x, y), place, strict=True)]
    frame = 7.0 + 300.0 * lit[0] * lit[1]
    found = FrameLinearPhase(8.0, "square", margin_px=4.0).extract(frame[None])
    np.testing.assert_allclose(found, [place], rtol=0, atol=1e-8)


@pytest.mark.parametrize("edge", [20.0, 55.0])
def test_a_mask_s_field_ends_two_degrees_beyond_the_field_of_view(edge):
    """A Sun there, along an axis, casts the pattern's middle as far off as the field reaches."""
    geometry = SensorGeometry(
        focal_length_mm=5.0,
        pixel_pitch_mm=0.01,
        centre_px=(300.0, 310.0),
        aperture_width_mm=0.2,
        aperture_shape="round",
        half_fov_deg=edge,
    )
    x, y, reach = design_pattern(geometry, "test")["field_px"]
    assert (x, y) == (300.0, 310.0)
    assert np.rad2deg(np.arctan2(reach * 0.01, 5.0)) == pytest.approx(edge + 2.0, abs=1e-6)


@pytest.mark.parametrize("width", [4, 12, 24])
def test_a_spot_as_large_as_its_aperture_is_listed_however_wide(width):
    frame = np.zeros((1, 60, 90))
    frame[0, 20 : 20 + width, 50 : 50 + width] = 500.0
    found = SpotList(((0.0, 0.0, float(width)),), spots=1).extract(frame)[0]
    assert found[:2].tolist() == pytest.approx([49.5 + width / 2, 19.5 + width / 2])
