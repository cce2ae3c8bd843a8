"""Methods of profiles on frames with one spot: closed forms, bounds, and what is undetermined."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.extractors.frames.peak import PixelMax
from algorithms.extractors.profiles.linear_phase import FrameLinearPhase
from algorithms.extractors.profiles.peak_detection import FramePeak
from benchmark import datasets
from benchmark.synthetic_features.frames import REFERENCE_SETS


def test_frame_variants_refuse_many_spots(geometry):
    holes = replace(geometry, apertures=((0.0, 0.0, 0.1), (1.0, 0.0, 0.1)))
    lines = replace(geometry, slits=((0.0, 0.0, 0.1),))
    for design, method in itertools.product((holes, lines), (FramePeak, FrameLinearPhase)):
        with pytest.raises(ValueError, match="one spot"):
            method.for_sensor(design)


@settings(deadline=None, derandomize=True, max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_the_peak_of_a_frame_is_its_largest_pixel(seed):
    frames = np.random.default_rng(seed).permutation(9 * 7 * 2).reshape(2, 9, 7)
    expected = [np.unravel_index(np.argmax(frame), frame.shape)[::-1] for frame in frames]
    np.testing.assert_array_equal(FramePeak().extract(frames), expected)


def test_a_saturated_disc_peaks_in_its_middle_and_two_suns_do_not():
    y, x = np.mgrid[:40, :50]
    one = np.where(np.hypot(x - 20, y - 15) < 5, 255, 3).astype(np.uint8)
    two = np.maximum(one, np.where(np.hypot(x - 40, y - 30) < 5, 255, 3)).astype(np.uint8)
    found = FramePeak(width_px=10.0).extract(np.stack([one, two]))
    np.testing.assert_array_equal(found[0], [20.0, 15.0])
    assert np.isnan(found[1]).all()


def test_a_spot_that_diffraction_widens_is_expected_as_wide_as_it_is():
    """cmos-single-aperture-pinhole: 0.47 mm between the dark rings of a hole of 0.02 mm."""
    pinhole = datasets.get("cmos-single-aperture-pinhole")
    method = FrameLinearPhase.for_sensor(pinhole.geometry)
    assert method.width_px == pytest.approx(0.47 / 2 / 0.024, rel=0.01)
    assert method.width_px / 2 + method.margin_px > 0.47 / 2 / 0.024
    samples = pinhole.generate("nominal", "test", 60)
    geometry = pinhole.geometry
    scale = geometry.focal_length_mm / geometry.pixel_pitch_mm
    true = geometry.centre_px + scale * samples.sun[:, :2] / samples.sun[:, 2:]
    found = method.extract(samples.observations) + samples.origin_px
    assert np.abs(found - true).max() < 1.5
    peaks = FramePeak.for_sensor(geometry).extract(samples.observations) + samples.origin_px
    assert np.abs(peaks - true).max() < 5.0


@pytest.mark.slow
def test_linear_phase_of_frames_is_within_thrice_the_bound_wherever_the_spot_is():
    for name, width, times in (
        ("disc", 16.0, 3.0),
        ("disc-512", 16.0, 3.0),
        ("gaussian", 8.0, 2.0),
    ):
        reference = REFERENCE_SETS[name]
        frames, centres = reference.frames(60)
        error = FrameLinearPhase(width).extract(frames) - centres
        assert np.sqrt(np.mean(error**2)) < times * reference.bound_px(centres[:15])
        whole = PixelMax().extract(frames) - centres
        assert np.mean(error**2) < 0.05 * np.mean(whole**2) or name == "gaussian"


def test_linear_phase_of_frames_tells_noise_cut_spots_and_two_suns():
    reference = REFERENCE_SETS["disc"]
    frames, centres = reference.frames(30)
    method = FrameLinearPhase(16.0)
    rng = np.random.default_rng(4)
    assert np.isnan(method.extract(rng.normal(20.0, 10.0, frames.shape))).all()
    cut = frames[:, :, int(centres[0, 0]) :][:1]
    assert np.isnan(method.extract(cut)).all()
    two = frames[0].astype(int) + np.roll(frames[0], (26, 26), axis=(0, 1))
    assert np.isnan(method.extract(two[None])).all()
