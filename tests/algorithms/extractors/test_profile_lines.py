"""Extractors of profiles: closed-form shadows of slits, brute force, and what is undetermined."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.contract import SensorGeometry
from algorithms.extractors.frames.threshold_average import MultipleThresholdCentroid
from algorithms.extractors.profiles.centroid import (
    ProfileCentroid,
    ProfileThresholdAverage,
    ProfileThresholdedCentroid,
)
from algorithms.extractors.profiles.eigen_analysis import EigenAnalysis
from algorithms.extractors.profiles.linear_phase import LinearPhase
from algorithms.extractors.profiles.peak_detection import PeakDetection
from algorithms.extractors.profiles.slit_lines import SlitLines
from algorithms.kernels import slit_patterns

#: The most a noiseless shadow may be off, px. PD knows whole pixels, and a width to err in.
FINE_PX = {
    LinearPhase: 0.02,
    EigenAnalysis: 0.02,
    ProfileThresholdedCentroid: 0.03,
    ProfileThresholdAverage: 0.06,
    PeakDetection: 4.5,
}

PARALLEL = SensorGeometry(
    focal_length_mm=2.0,
    pixel_pitch_mm=0.02,
    half_fov_deg=55.0,
    line_axes=("x", "y"),
    line_pixels=400,
    slits=((0.0, 0.0, 0.17),),
)
DESIGNS = {
    "one slit": PARALLEL,
    "five slits": replace(
        PARALLEL,
        slits=tuple((at, 0.0, 0.17) for at in (-1.1, -0.6, 0.0, 0.7, 1.5)),
        line_pixels=480,
    ),
    "sixteen slits": replace(
        PARALLEL,
        slits=tuple((0.4 * (number - 7.5), 0.0, 0.17) for number in range(16)),
        line_pixels=700,
    ),
    "an N": replace(
        PARALLEL,
        slits=((-4.0, 45.0, 0.2), (0.0, 0.0, 0.2), (4.0, 45.0, 0.2)),
        line_axes=("y",),
        line_pixels=1100,
    ),
    "a V": replace(
        PARALLEL,
        slits=((-3.7, 0.0, 0.2), (0.5, 45.0, 0.2)),
        line_axes=("x",),
        line_pixels=900,
    ),
    "crossed pairs": replace(
        PARALLEL,
        slits=((-5.2, -45.0, 0.2), (-4.5, -45.0, 0.2), (4.4, 45.0, 0.2), (5.3, 45.0, 0.2)),
        line_axes=("y",),
        line_pixels=1300,
    ),
}


def shadow(design: SensorGeometry, moved_mm: np.ndarray, peak: float = 2000.0) -> np.ndarray:
    """Profiles (N, W) of sharp slits, light integrated over pixels exactly; moved (N, 2)."""
    pitch, pixels = design.pixel_pitch_mm, design.line_pixels
    edges = (np.arange(pixels + 1) - pixels / 2.0) * pitch
    parts = []
    for axis in design.line_axes:
        along, across = moved_mm.T if axis == "x" else moved_mm.T[::-1]
        line = np.zeros((len(moved_mm), pixels))
        for position, slant_deg, width_mm in design.slits:
            slant = np.radians(slant_deg)
            at = position + along + across * np.tan(slant)
            half = width_mm / np.cos(slant) / 2.0
            lit = np.clip(edges, (at - half)[:, None], (at + half)[:, None])
            line += peak * np.diff(lit, axis=1) / pitch
        parts.append(line)
    return np.hstack(parts)


def soft_shadow(design: SensorGeometry, moved_mm: np.ndarray) -> np.ndarray:
    """Shadows with the edges that a disc of light 5 pixels wide gives."""
    steps = np.linspace(-1.0, 1.0, 41)[1:-1]
    weights = np.sqrt(1.0 - steps**2)
    axes = "xy".index(design.line_axes[0]) if len(design.line_axes) == 1 else [0, 1]
    lit = 0.0
    for step, weight in zip(steps, weights / weights.sum(), strict=True):
        there = moved_mm.copy()
        there[:, axes] += 2.5 * step * design.pixel_pitch_mm
        lit = lit + weight * shadow(design, there)
    return np.asarray(lit)


def where(design: SensorGeometry, moved_mm: np.ndarray) -> np.ndarray:
    return (design.line_pixels - 1) / 2.0 + moved_mm / design.pixel_pitch_mm


def displacements(count: int, reach_mm: float = 2.7, seed: int = 3) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-reach_mm, reach_mm, (count, 2))


def noisy(profiles: np.ndarray, sigma: float = 20.0, dark: float = 40.0) -> np.ndarray:
    rng = np.random.default_rng(8)
    return np.rint(rng.normal(profiles + dark, sigma)).clip(0, 4095).astype(np.uint16)


# Where an exact projection is reported


@pytest.mark.parametrize("method", FINE_PX, ids=lambda method: method.about.name)
@pytest.mark.parametrize("name", DESIGNS)
def test_a_shadow_is_reported_where_it_falls(name, method):
    design = DESIGNS[name]
    moved = displacements(20)
    found = method.for_sensor(design).extract(soft_shadow(design, moved))
    # Of slits of two slants the second coordinate is a difference of two shifts.
    tolerance = FINE_PX[method] * (1 if len(design.line_axes) == 2 else 2.5)
    np.testing.assert_allclose(found, where(design, moved), rtol=0, atol=tolerance)


@settings(deadline=None, derandomize=True, max_examples=30)
@given(st.tuples(st.floats(-2.7, 2.7), st.floats(-2.7, 2.7)), st.sampled_from(sorted(DESIGNS)))
def test_bcm_of_a_dark_free_shadow_errs_by_its_cut_pixels_only(moved, name):
    """A pixel lit to a part f counts at its centre: off by f (1 - f) / 2, at most 1/8."""
    design = DESIGNS[name]
    moved = np.array([moved])
    found = ProfileCentroid.for_sensor(design).extract(shadow(design, moved))
    # Each slit's two ends may add up; a difference of two shifts doubles it.
    worst = 2 * 0.125 / (0.17 / 0.02) * (1 if len(design.line_axes) == 2 else 2)
    np.testing.assert_allclose(found, where(design, moved), rtol=0, atol=worst)


def test_bcm_is_pulled_to_the_middle_by_dark_signal_unless_it_is_taken_off():
    moved = np.array([[2.0, -1.0]])  # both ends of the light cut a pixel alike
    lit = shadow(PARALLEL, moved) + 100.0
    true = where(PARALLEL, moved)
    middle = (PARALLEL.line_pixels - 1) / 2.0
    area = 2000.0 * 0.17 / 0.02
    pulled = middle + (true - middle) * area / (area + 100.0 * PARALLEL.line_pixels)
    plain = ProfileCentroid.for_sensor(PARALLEL)
    np.testing.assert_allclose(plain.extract(lit), pulled, rtol=0, atol=1e-9)
    without = replace(plain, subtract_dark=True)
    np.testing.assert_allclose(without.extract(lit), true, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    "method", [LinearPhase, EigenAnalysis], ids=lambda method: method.about.name
)
def test_narrower_and_blurred_light_keeps_its_place(method):
    """The reference is as wide as the slit; a thick mask and the Sun change that evenly."""
    moved = displacements(40)
    design = DESIGNS["five slits"]
    narrow = replace(design, slits=tuple((at, 0.0, 0.12) for at, _, _ in design.slits))
    kernel = np.hanning(9)[1:-1] / np.hanning(9).sum()
    lines = shadow(narrow, moved).reshape(-1, design.line_pixels)
    blurred = np.array([np.convolve(line, kernel, "same") for line in lines])
    found = method.for_sensor(design).extract(blurred.reshape(len(moved), -1))
    np.testing.assert_allclose(found, where(design, moved), rtol=0, atol=0.02)


# Oracles


@settings(deadline=None, derandomize=True, max_examples=60)
@given(st.integers(0, 2**32 - 1), st.integers(1, 4))
def test_pd_of_one_pattern_is_the_maxi_min(seed, count):
    """alg:PDsp and alg:PDmp, transcribed: the rule that nothing else is bright left out."""
    rng = np.random.default_rng(seed)
    places = np.sort(rng.choice(12, count, replace=False)) + 20
    line = rng.permutation(60).astype(float)
    best, n_peak = -1.0, None
    for n in range(-places.min(), 60 - places.max()):
        least = min(line[n + place] for place in places)
        if least > best:
            best, n_peak = least, n
    out = np.empty((1, 1))
    groups = np.zeros(count, dtype=np.int64)
    slit_patterns.match(
        line[None], np.array([-1.0]), places, groups, np.zeros(1), 0.0, 0.0, 60, 0, out
    )
    assert out[0, 0] == n_peak


@settings(deadline=None, derandomize=True, max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_pd_of_two_patterns_is_the_brightest_pair_a_sun_can_cast(seed):
    rng = np.random.default_rng(seed)
    places, groups = np.array([10, 25, 40]), np.array([1, 0, 1])
    tangents = np.array([rng.uniform(-0.5, 0.5), rng.choice([-1.2, 0.9, 1.0])])
    reach, apart = rng.uniform(4.0, 14.0), rng.uniform(1.0, 8.0)
    line = rng.uniform(0.0, 1.0, 50)
    best, pair = -1.0, (np.nan, np.nan)
    for first, second in itertools.product(range(-25, 25), range(-10, 10)):
        across = (second - first) / (tangents[1] - tangents[0])
        along = first - across * tangents[0]
        at = places + np.array([first, second])[groups]
        clear = min(abs(at[1] - at[0]), abs(at[1] - at[2])) >= apart
        if abs(across) <= reach and abs(along) <= reach and clear:
            score = line[at[1]] + min(line[at[0]], line[at[2]])
            if score > best:
                best, pair = score, (first, second)
    out = np.empty((1, 2))
    slit_patterns.match(
        line[None], np.array([-1.0]), places, groups, tangents, reach, apart, 50, 0, out
    )
    np.testing.assert_array_equal(out[0], pair)


def test_unweighted_phases_of_all_frequencies_fail_where_the_weighted_low_ones_do_not():
    """The survey's printed fit, against the corrected one, on the same noisy light."""
    moved = displacements(60, 2.0)
    lines = noisy(shadow(PARALLEL, moved))
    true = where(PARALLEL, moved)
    pixels = PARALLEL.line_pixels
    zero = np.fft.fft(shadow(PARALLEL, np.zeros((1, 2))).reshape(2, -1)[0])[1 : pixels // 2]
    k = np.arange(1, pixels // 2)
    phase = np.unwrap(np.angle(np.fft.fft(lines[:, :pixels])[:, 1 : pixels // 2] / zero))
    slope = phase @ k / (k @ k)
    naive = (pixels - 1) / 2.0 - slope * pixels / (2 * np.pi)
    found = LinearPhase.for_sensor(PARALLEL).extract(lines)
    assert np.sqrt(np.mean((found - true) ** 2)) < 0.05
    assert np.sqrt(np.mean((naive - true[:, 0]) ** 2)) > 1.0


@pytest.mark.parametrize("crossing", ["pixel", "linear"])
def test_mt_acm_of_a_line_is_that_of_a_frame_with_its_sums(crossing):
    moved = displacements(20)
    lines = noisy(shadow(PARALLEL, moved)).reshape(len(moved), 2, -1).astype(float)
    method = replace(ProfileThresholdAverage.for_sensor(PARALLEL), crossing=crossing)
    frames = lines[:, 1, :, None] * lines[:, 0, None, :]
    expected = MultipleThresholdCentroid(crossing=crossing).extract(frames)
    found = method.extract(lines.reshape(len(moved), -1))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)


# What cannot be determined

TELLING = (PeakDetection, LinearPhase, EigenAnalysis)


def telling(method: type[SlitLines], design: SensorGeometry) -> Any:
    """Return the method for a design; PD tells nothing apart unless it is asked to."""
    found = method.for_sensor(design)
    return replace(found, alone=True) if method is PeakDetection else found


def test_pd_answers_as_published_where_it_is_not_asked_for_light_alone():
    """alg:PDsp has no way out: noise within a wide spot's even light moves it, no more."""
    design = replace(PARALLEL, slits=((0.0, 0.0, 0.6),))
    moved = displacements(60)
    lit = noisy(shadow(design, moved))
    found = PeakDetection.for_sensor(design).extract(lit)
    np.testing.assert_allclose(found, where(design, moved), rtol=0, atol=16.0)
    assert np.isfinite(PeakDetection.for_sensor(design).extract(noisy(0 * lit))).all()
    assert np.isfinite(telling(PeakDetection, design).extract(lit)).all()


@pytest.mark.parametrize("method", TELLING, ids=lambda method: method.about.name)
@pytest.mark.parametrize("name", DESIGNS)
def test_noise_alone_two_suns_and_a_missing_slit_are_nan(name, method):
    design = DESIGNS[name]
    extractor = telling(method, design)
    moved = displacements(40)
    lit = shadow(design, moved)
    assert np.isfinite(extractor.extract(noisy(lit))).all()
    assert np.isnan(extractor.extract(noisy(0 * lit))).all()
    apart = np.abs(moved - np.roll(moved, 1, axis=0)).min(axis=1) > 0.5
    if len(design.slits) < 16:  # a second comb half a tooth beside the first is another pattern
        both = extractor.extract(noisy(lit + np.roll(lit, 1, axis=0)))
        assert np.isnan(both[apart]).all()
    missing = replace(design, slits=design.slits[1:])
    if missing.slits:
        assert np.isnan(extractor.extract(noisy(shadow(missing, moved)))).all()


@pytest.mark.parametrize("method", TELLING, ids=lambda method: method.about.name)
def test_slits_off_the_line_are_never_taken_for_their_neighbours(method):
    """Off the end by one slit of the comb: nothing, not a whole period's error."""
    design = DESIGNS["sixteen slits"]
    moved = np.column_stack([np.linspace(2.7, 5.5, 80), np.zeros(80)])
    found = telling(method, design).extract(noisy(shadow(design, moved)))
    seen = np.isfinite(found[:, 0])
    assert seen[:20].all()
    assert not seen[-20:].any()
    np.testing.assert_allclose(found[seen], where(design, moved)[seen], rtol=0, atol=6.0)


@pytest.mark.parametrize("method", TELLING, ids=lambda method: method.about.name)
def test_peaks_that_merge_or_cross_are_right_or_nan(method):
    """The V's slits cross in the mask: the slanted one's spot passes over the other's."""
    design = replace(DESIGNS["a V"], slits=((-0.4, 0.0, 0.2), (0.4, 45.0, 0.2)))
    across = np.linspace(-2.7, 2.7, 150)
    moved = np.column_stack([np.full(150, 0.3), across])
    found = telling(method, design).extract(noisy(shadow(design, moved)))
    gap = np.abs(0.8 + across)
    seen = np.isfinite(found[:, 0])
    assert not seen[gap < 0.2].any()
    # Either spot may be either slit's where both readings are of Suns in the field.
    other = np.column_stack([moved[:, 0] + 0.8 + across, -1.6 - across])
    wrong = np.minimum(
        np.abs(found - where(design, moved)).max(axis=1),
        np.abs(found - where(design, other)).max(axis=1),
    )
    assert (wrong[seen] < 25).all()


def test_saturated_light_peaks_in_its_middle():
    moved = displacements(30)
    lit = np.minimum(shadow(PARALLEL, moved, peak=9000.0), 4095.0)
    found = PeakDetection.for_sensor(PARALLEL).extract(lit)
    np.testing.assert_allclose(found, where(PARALLEL, moved), rtol=0, atol=1.0)


# Designs


def test_designs_that_do_not_give_two_coordinates_are_refused():
    for design, why in (
        (replace(PARALLEL, line_axes=("x",)), "two coordinates"),
        (replace(PARALLEL, line_axes=("x", "x")), "two coordinates"),
        (replace(PARALLEL, slits=((0.0, 0.0, 0.1), (1.0, 9.0, 0.1), (2.0, 20.0, 0.1))), "slants"),
        (replace(PARALLEL, line_pixels=None), "line_pixels"),
        (replace(PARALLEL, slits=None), "slits"),
    ):
        for method in (*FINE_PX, ProfileCentroid):
            with pytest.raises(ValueError, match=why):
                method.for_sensor(design)


def test_windows_hold_a_spots_light_and_not_its_neighbours():
    comb = SlitLines.for_sensor.__func__(PeakDetection, DESIGNS["sixteen slits"])
    assert 2 * comb.half_px <= 0.4 / 0.02
    single = PeakDetection.for_sensor(PARALLEL)
    blur = 0.0093 * 2.0 / np.cos(np.arctan(np.sqrt(2) * np.tan(np.radians(55.0)))) ** 2
    assert single.half_px >= (0.17 + blur) / 2.0 / 0.02
