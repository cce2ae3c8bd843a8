"""BSCM against a transcription of its pseudocode with SciPy, OpenCV's corners, and physics."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from algorithms.contract import SensorGeometry
from algorithms.extractors.frames.cameras.black_sun import BlackSunCentroid


def black_sun(centres, radius=4.0, *, halo=10.0, shape=(44, 48), noise=5.0, seed=0):
    """Frames of soft-rimmed black discs in saturated halos that fall off outside."""
    y, x = np.mgrid[: shape[0], : shape[1]]
    rng = np.random.default_rng(seed)
    frames = np.empty((len(centres), *shape))
    for frame, (a, b) in zip(frames, centres, strict=True):
        r = np.hypot(x - a, y - b)
        bright = 1000 / (1 + np.exp(2.0 * (r - halo)))
        frame[:] = 20 + bright / (1 + np.exp(-4.0 * (r - radius)))
    frames += noise * rng.standard_normal(frames.shape)
    return np.clip(np.rint(frames), 0, 1023).astype(np.uint16)


def as_printed(frame, loops=16, highest=0.9, lowest=0.1, radius=1.5):
    """alg:BCSM: blur, masks of descending thresholds, holes in contours, corners that survive."""
    image = ndimage.gaussian_filter(frame.astype(float), 1.0, mode="nearest", truncate=3.0)
    low, high = image.min(), image.max()
    corners = []
    for loop in range(loops):
        part = highest + (loop + 0.5) * (lowest - highest) / loops
        mask = image > low + part * (high - low)
        holes = ndimage.binary_fill_holes(mask) & ~mask
        labels, count = ndimage.label(holes)
        here = []
        for n in range(1, count + 1):
            hole = labels == n
            if hole.sum() < np.pi * radius**2 / 2:
                continue
            across = np.diff(hole.astype(int), axis=1) != 0
            down = np.diff(hole.astype(int), axis=0) != 0
            x = np.nonzero(across)[1].mean() + 0.5
            y = np.nonzero(down)[0].mean() + 0.5
            here.append((hole.sum(), x, y))
        corners.append(max(here)[1:] if here else (np.nan, np.nan))
    steps = np.hypot(*np.diff(corners, axis=0).T)
    assert (steps[~np.isnan(steps)] <= 0.5).all()  # one run, so that its mean is that of all
    return np.nanmean(corners, axis=0)


centres = st.tuples(st.floats(16.0, 30.0), st.floats(16.0, 26.0))


@settings(deadline=None, derandomize=True, max_examples=30)
@given(centres, st.floats(3.0, 5.0), st.integers(0, 9))
def test_bscm_is_the_printed_loop(centre, radius, seed):
    frames = black_sun([centre], radius, seed=seed)
    np.testing.assert_allclose(
        BlackSunCentroid().extract(frames)[0], as_printed(frames[0]), rtol=0, atol=1e-9
    )


def test_opencvs_contours_of_the_hole_have_the_same_centre():
    """The largest inner contour's moments, averaged over the thresholds."""
    for n, centre in enumerate(np.random.default_rng(2).uniform(18, 26, (8, 2))):
        frame = black_sun([centre], seed=n)[0]
        blurred = cv2.GaussianBlur(frame.astype(np.float32), (7, 7), 1.0)
        middles = []
        for part in np.linspace(0.875, 0.125, 16):
            dark = np.where(blurred > part * blurred.max(), 0, 255).astype(np.uint8)
            outlines, _ = cv2.findContours(dark, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
            hole = min(outlines, key=lambda o: abs(cv2.contourArea(o) - 40))
            m = cv2.moments(hole)
            middles.append((m["m10"] / m["m00"], m["m01"] / m["m00"]))
        found = BlackSunCentroid().extract(frame[None])
        np.testing.assert_allclose(found[0], np.mean(middles, axis=0), atol=0.1)


@settings(deadline=None, derandomize=True, max_examples=30)
@given(centres)
def test_a_black_sun_is_found_to_a_tenth_of_a_pixel(centre):
    np.testing.assert_allclose(BlackSunCentroid().extract(black_sun([centre])), [centre], atol=0.1)


def test_a_brighter_patch_and_dead_pixels_do_not_move_it():
    where = np.random.default_rng(3).uniform(18, 26, (20, 2))
    frames = black_sun(where)
    frames[:, 30:40, 30:44] = 1023  # an irregular halo
    frames[:, 5::9, 4::7] = 20  # dead
    errors = BlackSunCentroid().extract(frames) - where
    assert np.hypot(*errors.T).max() < 0.4


def test_a_gap_between_bright_patches_is_not_a_black_sun():
    """Patches around a darker gap, which closes as the threshold falls."""
    y, x = np.mgrid[:60, :60]
    gap = np.zeros((60, 60))
    for turn in np.linspace(0, 2 * np.pi, 7)[:-1]:
        a, b = 30 + 10 * np.cos(turn), 30 + 10 * np.sin(turn)
        gap += 1500 / (1 + ((x - a) ** 2 + (y - b) ** 2) / 25) ** 2
    frame = np.minimum(gap, 1000)
    assert frame[30, 30] < 0.9 * frame.max()
    assert np.isnan(BlackSunCentroid().extract(frame[None])).all()


def test_bad_frames_are_not_found():
    y, x = np.mgrid[:44, :48]
    disc = 1000.0 * (np.hypot(x - 22, y - 20) < 9)
    ring_cut = black_sun([(2.0, 20.0)], noise=0)[0]
    two = np.maximum(*black_sun([(12.0, 12.0), (34.0, 30.0)], halo=8.0, noise=0))
    noise = np.random.default_rng(4).normal(100, 10, (44, 48))
    for frame in (disc, ring_cut, two, noise):
        assert np.isnan(BlackSunCentroid().extract(frame[None])).all()


def test_only_a_lens_makes_a_black_sun():
    with pytest.raises(ValueError, match="lens_distortion"):
        BlackSunCentroid.for_sensor(SensorGeometry(aperture_width_mm=0.2, pixel_pitch_mm=0.01))
