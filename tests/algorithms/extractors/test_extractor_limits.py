"""Where extractors begin and end: faint light, the far side of wide frames, published defaults."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import jn_zeros

from algorithms.contract import SensorGeometry, UnsuitableDesignError
from algorithms.extractors.frames.multi_spot import mean_shift_kernel
from algorithms.extractors.frames.multi_spot.aperture_design import design_pattern
from algorithms.extractors.frames.multi_spot.spot_list import SpotList
from algorithms.extractors.frames.windows import follow_spot
from algorithms.extractors.profiles.linear_phase import FrameLinearPhase
from algorithms.extractors.profiles.peak_detection import FramePeak
from algorithms.extractors.profiles.single_spot import require_one_spot
from algorithms.extractors.profiles.spot_spectra import SpotSpectra


@pytest.mark.parametrize("shape", [(20, 50), (50, 20)])
@pytest.mark.parametrize("share", [(0.1, 0.2), (0.5, 0.5), (0.9, 0.85)])
def test_a_window_s_histogram_is_of_all_pixels_within_its_radius(shape, share):
    bins = np.random.default_rng(1).integers(0, 5, shape)
    x, y, radius = share[0] * shape[1], share[1] * shape[0], 6.5
    sums = np.empty((5, 4))
    total = mean_shift_kernel._window(bins, x, y, radius, sums)
    rows, columns = np.indices(shape)
    dx, dy = columns - x, rows - y
    near = dx**2 + dy**2 <= radius**2
    kernel = 1 - (dx**2 + dy**2) / radius**2
    expected = [
        [values[near & (bins == u)].sum() for values in (kernel, np.ones(shape), dx, dy)]
        for u in range(5)
    ]
    np.testing.assert_allclose(sums, expected, atol=1e-9)
    assert total == pytest.approx(kernel[near].sum())


@pytest.mark.parametrize("place", [(14.5, 4.0), (5.0, 8.5), (-0.5, 4.0), (5.0, -0.5)])
def test_a_window_does_not_follow_what_lies_outside_the_frame(place):
    asked = []
    found = np.array([place])
    follow_spot(np.array([[5.0, 4.0]]), 5, (9, 15), lambda windows: asked.append(1) or found)
    assert len(asked) == 1


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


@pytest.mark.parametrize("padded", [False, True])
@pytest.mark.parametrize("shape", ["square", "round"])
def test_spectra_reach_to_half_the_sampling(shape, padded):
    """The light's integral at every frequency that the samples have."""
    width, half_px = 4.3, 6
    spectra = SpotSpectra.of(
        np.array([20.0]), np.zeros(1, dtype=np.int64), [width], shape, half_px, padded
    )
    assert spectra.period == (25 if padded else 13)
    across = ((np.arange(20_000) + 0.5) / 20_000 - 0.5) * width
    round_light = np.sqrt(1.0 - (2.0 * across / width) ** 2) * 4.0 / np.pi
    light = round_light if shape == "round" else np.ones_like(across)
    zero = jn_zeros(1, 1)[0] / np.pi if shape == "round" else 1.0
    assert spectra.zero == pytest.approx(zero / width)
    frequencies = np.fft.rfftfreq(spectra.period)
    waves = np.cos(2.0 * np.pi * np.outer(frequencies, across))
    expected = width * (waves * light).mean(axis=1) * np.sinc(frequencies)
    np.testing.assert_allclose(spectra.reference, [expected], rtol=0, atol=1e-4)


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


@pytest.mark.parametrize(
    ("apertures", "right"),
    [(None, True), (((0.0, 0.0, 0.1),), True), (((0.0, 0.0, 0.1), (1.0, 0.0, 0.1)), False)],
)
def test_a_method_of_one_spot_takes_a_mask_of_one_aperture(apertures, right):
    geometry = SensorGeometry(apertures=apertures)
    if right:
        require_one_spot(geometry, "test")
    else:
        with pytest.raises(UnsuitableDesignError, match="test"):
            require_one_spot(geometry, "test")
