"""Reticles and verniers against light written down here."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.angles import separation_deg, sun_from_angles
from algorithms.contract import FeatureKind, SensorGeometry, UnsuitableDesignError
from algorithms.models.multiplex.reticle import ReticlePhase
from algorithms.models.multiplex.vernier import OpticalVernier


def design(places, width_mm, pixels, pitch_mm, focal_mm):
    return SensorGeometry(
        focal_length_mm=focal_mm,
        pixel_pitch_mm=pitch_mm,
        centre_px=((pixels - 1) / 2.0,) * 2,
        line_axes=("x", "y"),
        line_pixels=pixels,
        slits=tuple((place, 0.0, width_mm) for place in places),
        half_fov_deg=50.0,
    )


RETICLE = design([0.4 * (k - 7.5) for k in range(16)], 0.2, 700, 0.014, 1.2)
VERNIER = design([0.32 * (k - 7.5) for k in range(16) if k not in {2, 11}], 0.15, 104, 0.1, 1.0)


def light(geometry, shifts_mm, blur=1.0):
    """Light (N, L) of slits with sloping edges `blur` px wide, displaced by (N,)."""
    places, _, widths = np.array(geometry.slits).T
    pitch, pixels = geometry.pixel_pitch_mm, geometry.line_pixels
    at = pitch * (np.arange(pixels) - (pixels - 1) / 2.0)
    away = np.abs(at - shifts_mm[:, None, None] - places[:, None]) / pitch
    return np.clip((widths[0] / pitch / 2.0 - away) / blur + 0.5, 0.0, 1.0).sum(axis=1)


def signals(geometry, sun, **kwargs):
    shifts = geometry.focal_length_mm * sun[:, :2] / sun[:, 2:]
    return np.hstack([light(geometry, column, **kwargs) for column in shifts.T])


def field(count, half_deg=48.0, seed=1):
    return sun_from_angles(np.random.default_rng(seed).uniform(-half_deg, half_deg, (count, 2)))


@pytest.mark.parametrize(("cls", "geometry"), [(ReticlePhase, RETICLE), (OpticalVernier, VERNIER)])
def test_every_slit_is_told_from_the_next(cls, geometry):
    """Of directions all over the field none is off by as much as half a pixel."""
    model, sun = cls.for_sensor(geometry, FeatureKind.SIGNALS), field(300)
    spots = model.spots(signals(geometry, sun))
    true = (geometry.line_pixels - 1) / 2.0 + sun[:, :2] / sun[:, 2:] * (
        geometry.focal_length_mm / geometry.pixel_pitch_mm
    )
    assert np.abs(spots - true).max() < 0.1


def test_light_that_is_a_wave_is_placed_exactly():
    """A raised cosine under the reticle has its phase and no other wave."""
    model = ReticlePhase.for_sensor(RETICLE, FeatureKind.SIGNALS)
    period = 0.4 / 0.014
    at, middle = np.arange(700), 349.5
    shifts = np.linspace(-100.0, 100.0, 41)
    inside = np.clip(8 * period + 0.5 - np.abs(at - middle - shifts[:, None]), 0.0, 1.0)
    rows = inside * (1 - np.cos(2 * np.pi * (at - middle - shifts[:, None]) / period))
    spots = model.spots(np.hstack([rows, rows[::-1]]))
    np.testing.assert_allclose(spots, middle + np.stack([shifts, shifts[::-1]], 1), atol=2e-3)


@pytest.mark.parametrize("slits", [4, 16])
def test_noise_falls_with_the_root_of_the_slits(slits):
    """The error of a sinusoid's phase: ``sigma p sqrt(2 / M) / (2 pi a)`` over M pixels."""
    geometry = design([0.4 * (k - (slits - 1) / 2) for k in range(slits)], 0.2, 700, 0.014, 1.2)
    model = ReticlePhase.for_sensor(geometry, FeatureKind.SIGNALS)
    rng, period = np.random.default_rng(4), 0.4 / 0.014
    clean = light(geometry, np.zeros(1))
    noisy = clean + 0.02 * rng.standard_normal((800, 700))
    spots = model.spots(np.hstack([noisy[:400], noisy[400:]]))
    amplitude = 2.0 / np.pi  # of the fundamental of a half-open reticle
    expected = 0.02 * period * np.sqrt(2.0 / (slits * period)) / (2.0 * np.pi * amplitude)
    assert spots.std() == pytest.approx(expected, rel=0.08)


def test_a_vernier_is_finer_than_the_phase_in_one_mark():
    """One slit's phase in three pixels errs with its place; slits on all phases cancel that."""
    model = OpticalVernier.for_sensor(VERNIER, FeatureKind.SIGNALS)
    shifts = np.linspace(-0.15, 0.15, 61)
    rows = light(VERNIER, shifts)
    off = model.spots(np.hstack([rows, rows]))[:, 0] - 51.5 - shifts / 0.1
    pixels = np.arange(104)
    one = light(design([0.16], 0.15, 104, 0.1, 1.0), shifts)
    phase = np.angle((one * np.exp(2j * np.pi * (pixels - 53.1) / 3.0)).sum(axis=1))
    alone = phase * 3.0 / (2.0 * np.pi) - shifts / 0.1
    assert off.std() < alone.std() / 3.0


@pytest.mark.parametrize(("cls", "geometry"), [(ReticlePhase, RETICLE), (OpticalVernier, VERNIER)])
def test_light_without_the_pattern_is_no_answer(cls, geometry):
    model, pixels = cls.for_sensor(geometry, FeatureKind.SIGNALS), geometry.line_pixels
    half = light(geometry, np.full(1, 100.0))  # off the line
    cut = light(geometry, np.full(1, 0.5 * pixels * geometry.pixel_pitch_mm))  # half of it
    flat = np.ones((1, pixels))
    for row in (half, cut, flat, 0.0 * flat):
        assert np.isnan(model.spots(np.hstack([row, row]))).all()


@pytest.mark.parametrize(("cls", "geometry"), [(ReticlePhase, RETICLE), (OpticalVernier, VERNIER)])
def test_a_calibrated_ruler_finds_suns_between_its_poses(cls, geometry):
    model, sun = cls.for_sensor(geometry, FeatureKind.SIGNALS), field(260)
    features = signals(geometry, sun)
    error = separation_deg(model.fit(features[:200], sun[:200]).predict(features[200:]), sun[200:])
    step = np.degrees(geometry.pixel_pitch_mm / geometry.focal_length_mm)
    assert np.isfinite(error).mean() > 0.9
    assert np.sqrt(np.nanmean(error**2)) < step / 50.0


def test_each_ruler_refuses_the_others_slits():
    with pytest.raises(UnsuitableDesignError, match="gaps"):
        ReticlePhase.for_sensor(VERNIER, FeatureKind.SIGNALS)
    with pytest.raises(UnsuitableDesignError, match="gaps"):
        OpticalVernier.for_sensor(RETICLE, FeatureKind.SIGNALS)
    with pytest.raises(UnsuitableDesignError, match="raster"):
        ReticlePhase.for_sensor(design([0.0, 0.4, 0.9, 1.2], 0.2, 700, 0.014, 1.2), "signals")


def test_a_verniers_slits_stand_at_least_three_pixels_apart():
    three, two = (
        design([pitch * (k - 7.5) for k in range(16) if k not in {2, 11}], 0.15, 104, 0.1, 1.0)
        for pitch in (0.32, 0.22)
    )
    assert OpticalVernier.for_sensor(three, FeatureKind.SIGNALS).line_pixels == 104
    with pytest.raises(UnsuitableDesignError, match="three whole pixels"):
        OpticalVernier.for_sensor(two, FeatureKind.SIGNALS)
