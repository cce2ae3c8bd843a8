"""The four methods of the studies, and what they make of one image under noise."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from algorithms.contract import Extractor, Floats
from algorithms.extractors.profiles.centroid import ProfileThresholdedCentroid
from algorithms.extractors.profiles.eigen_analysis import EigenAnalysis
from algorithms.extractors.profiles.linear_phase import LinearPhase
from algorithms.extractors.profiles.peak_detection import PeakDetection
from benchmark.claims.benches import times_s
from benchmark.claims.experiments.profiles.slit_images import SlitImages, move

BCTM, PD, LINEAR, EIGEN = "bctm-profile", "pd", "linear-phase", "eigen-analysis"
METHODS: Mapping[str, type[Extractor]] = {
    BCTM: ProfileThresholdedCentroid,
    PD: PeakDetection,
    LINEAR: LinearPhase,
    EIGEN: EigenAnalysis,
}
#: Standard deviations of the noise, in shares of an image's brightness.
NOISES = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5)
#: Of a noise that no method has trouble with, under which run times are taken.
TIMED_NOISE = 0.01
_PROFILES = 400
#: Few, so that what else the machine does seldom falls into a call.
_TIMED_PROFILES = 100
_BOUND_PROFILES = 32


def errors_by_noise(rng: np.random.Generator) -> tuple[dict[str, list[float]], list[float]]:
    """Errors of each method in pixels at each of `NOISES`, and their bounds.

    All methods see the same profiles, and all noises the same displacements.
    """
    images = SlitImages()
    places = move(_PROFILES, rng)
    light = images.light(places)
    found: dict[str, list[float]] = {name: [] for name in METHODS}
    bounds = []
    for noise in NOISES:
        profiles = light + noise * rng.standard_normal(light.shape)
        for name, method in METHODS.items():
            found[name].append(images.error_px(method, profiles, places))
        bounds.append(images.bound_px(places[:_BOUND_PROFILES], 1.0, _even(noise)))
    return found, bounds


def times_of(
    images: SlitImages, names: Sequence[str], rng: np.random.Generator
) -> Mapping[str, float]:
    """Run times of methods on a batch of 100 profiles, s."""
    light = images.light(move(_TIMED_PROFILES, rng))
    profiles = light + TIMED_NOISE * rng.standard_normal(light.shape)
    made = {name: METHODS[name].for_sensor(images.geometry()) for name in names}
    return times_s(**{name: _call(method, profiles) for name, method in made.items()})


def _call(method: Extractor, profiles: Floats) -> Callable[[], Floats]:
    return lambda: method.extract(profiles)


def _even(noise: float) -> Callable[[Floats], Floats]:
    return lambda expected: np.full_like(expected, noise**2)
