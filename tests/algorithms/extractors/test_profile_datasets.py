"""Extractors of profiles on every standard dataset of profiles, as simulated."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.extractors.profiles.eigen_analysis import EigenAnalysis
from algorithms.extractors.profiles.linear_phase import LinearPhase
from algorithms.extractors.profiles.peak_detection import PeakDetection
from benchmark import datasets

METHODS = (PeakDetection, LinearPhase, EigenAnalysis)
#: Sets whose spots are closer than whole pixels keep apart.
CLOSE = {"ccd-vernier"}


def unsure(method, profiles):
    """(N,) whether light beside a pattern is half as bright as its darkest spot, on any line.

    By trying all shifts by whole pixels: the refusal that the methods promise. Between windows of
    three pixels about spots 3.2 pixels apart there are pixels that light of the pattern itself
    falls on, when its spots' middles lie near borders of pixels.
    """
    spots = np.rint(method.pattern()).astype(int)
    length = method.line_pixels
    found = []
    for line in np.reshape(profiles, (-1, length)):
        light = line - np.median(line)
        shifts = range(-spots.min(), length - spots.max())
        placed = max((spots + shift for shift in shifts), key=lambda at: light[at].min())
        near = np.abs(np.arange(length)[:, None] - placed).min(axis=1) <= method.half_px
        found.append(light[~near].max() >= light[placed].min() / 2.0)
    return np.reshape(found, (len(profiles), -1)).any(axis=1)


@pytest.mark.parametrize(
    "name",
    [name for name in datasets.names() if datasets.get(name).observation == "profiles"],
)
def test_simulated_suns_are_found_where_light_falls(name):
    """To a few percent of the mask's height: assembly, or what a cubic leaves of the glass."""
    preset = datasets.get(name)
    design = preset.geometry
    samples = preset.generate("nominal", "test", 60)
    tangents = samples.sun[:, :2] / samples.sun[:, 2:]
    moved_px = design.focal_length_mm * tangents / design.pixel_pitch_mm
    places = (design.line_pixels - 1) / 2.0 + moved_px
    for method in METHODS:
        found = method.for_sensor(design).extract(samples.observations)
        refused = np.zeros(len(found), dtype=np.bool_)
        if name in CLOSE:
            refused = unsure(method.for_sensor(design), samples.observations)
            assert refused.mean() < 0.1
        assert (np.isnan(found).any(axis=1) == refused).all()
        found, true = found[~refused], places[~refused]
        bent = found - true
        if design.cover_glass is not None:
            fit = np.column_stack([true, true**3, np.ones(len(true))])
            slopes = np.linalg.lstsq(fit, found, rcond=None)[0]
            assert (np.diag(slopes[:2]) > 0.5).all()
            bent = found - fit @ slopes
        # A peak is anywhere in the light of its slit.
        wide = max(slit[2] for slit in design.slits) if method is PeakDetection else 0.0
        allowed = (0.04 * design.focal_length_mm + wide) / design.pixel_pitch_mm
        assert np.sqrt(np.mean(bent**2)) < allowed
