"""Extractors of profiles on every standard dataset of profiles, as simulated."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.extractors.profiles.eigen_analysis import EigenAnalysis
from algorithms.extractors.profiles.linear_phase import LinearPhase
from algorithms.extractors.profiles.peak_detection import PeakDetection
from benchmark import datasets
from benchmark.datasets.conditions.flight import FlightPreset

METHODS = (PeakDetection, LinearPhase, EigenAnalysis)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.slow if "orbit" in name else ())
        for name in datasets.names()
        if datasets.get(name).observation == "profiles"
    ],
)
def test_simulated_suns_are_found_where_light_falls(name):
    """To a few percent of the mask's height: assembly, or what a cubic leaves of the glass."""
    preset = datasets.get(name)
    design = preset.geometry
    count = 240 if isinstance(preset, FlightPreset) else 30  # an orbit begins with its eclipse
    samples = preset.generate("nominal", "test", count)
    seen = preset.bound("nominal", "test", count).observable
    sun, observations = samples.sun[seen], samples.observations[seen]
    tangents = sun[:, :2] / sun[:, 2:]
    moved_px = design.focal_length_mm * tangents / design.pixel_pitch_mm
    places = (design.line_pixels - 1) / 2.0 + moved_px
    for method in METHODS:
        found = method.for_sensor(design).extract(observations)
        assert np.isfinite(found).all()
        bent = found - places
        if design.cover_glass is not None:
            fit = np.column_stack([places, places**3, np.ones(len(places))])
            slopes = np.linalg.lstsq(fit, found, rcond=None)[0]
            assert (np.diag(slopes[:2]) > 0.5).all()
            bent = found - fit @ slopes
        # A peak is anywhere in the light of its slit.
        wide = max(slit[2] for slit in design.slits) if method is PeakDetection else 0.0
        allowed = (0.04 * design.focal_length_mm + wide) / design.pixel_pitch_mm
        assert np.sqrt(np.mean(bent**2)) < allowed
