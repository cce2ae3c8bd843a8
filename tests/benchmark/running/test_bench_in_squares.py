"""Own error and bench add in squares, found without the code that scores.

Benches, angles and means are written here again; from the project come only the rendered samples,
the correction by references, and the methods.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.pipeline import Pipeline, extract_features
from benchmark import datasets
from benchmark.contract import ON_BENCH
from benchmark.datasets.corrected import correct, correction
from benchmark.plan.parts import installed_parts
from benchmark.results.store import PUBLISHED, Store

Array = NDArray[np.float64]
BENCHES = 20
#: Of a turntable: mounting, squareness, eccentricity (root mean square) and repeatability, degrees.
SIZES = (0.01, 0.005, 0.005, 0.003)


def sampled(number: int) -> list[tuple[str, str, str]]:
    """Pipelines that the record has on drawn benches, evenly over the data sets on turntables."""
    found = sorted(
        {
            (row["dataset"], row["extractor"], row["model"])
            for row in Store(PUBLISHED).rows(unit=None)
            if row["condition"] == ON_BENCH
            and row["rms_all_answers_deg"] is not None
            and row["rms_all_answers_deg"] < 0.1
            and "nn" not in row["model"]
            and "orbit" not in row["dataset"]
        }
    )
    places = np.linspace(0, len(found) - 1, number).round().astype(int)
    return [found[place] for place in dict.fromkeys(places.tolist())]


def reported(sun: Array, fixed: Array, random: Array) -> Array:
    """Directions (N, 3) that a turntable reads: outer axis x, inner y.

    `fixed` are eight standard normal numbers, `random` two each pose (N, 2).
    """
    mounting, squareness, eccentricity, repeated = np.radians(SIZES)
    angles = np.arctan2(sun[:, 1], sun[:, 2]), np.arcsin(np.clip(sun[:, 0], -1.0, 1.0))
    waves = eccentricity * fixed[:4].reshape(2, 2)
    outer, inner = (
        angle + wave[0] * np.cos(angle) + wave[1] * np.sin(angle) + repeated * stops
        for angle, wave, stops in zip(angles, waves, random.T, strict=True)
    )
    skew = squareness * fixed[4]
    x, y, z = np.sin(inner), np.zeros(len(sun)), np.cos(inner)
    x, y = np.cos(skew) * x - np.sin(skew) * y, np.sin(skew) * x + np.cos(skew) * y
    y, z = np.cos(outer) * y + np.sin(outer) * z, np.cos(outer) * z - np.sin(outer) * y
    seen = np.stack([x, y, z], axis=1)
    return seen + np.cross(mounting * fixed[5:], seen)


def angles_deg(one: Array, other: Array) -> Array:
    across = np.linalg.norm(np.cross(one, other), axis=1)
    return np.degrees(np.arctan2(across, np.sum(one * other, axis=1)))


def mean_square(errors: Array) -> float:
    return float(np.nanmean(errors**2))


def on_drawn_benches(dataset: str, extractor_name: str, model_name: str) -> tuple[float, ...]:
    """Mean squares of a pipeline: own error, error on drawn benches, error of those benches."""
    rng = np.random.default_rng([len(dataset), len(model_name), 33])
    parts, preset = installed_parts(), datasets.get(dataset).for_unit(0)
    condition = preset.conditions[0]
    geometry = preset.geometry_for(condition)
    by = correction(preset, condition)
    extractor = parts.extractor(extractor_name).for_sensor(geometry)
    known, test = (preset.generate(condition, name) for name in ("calibration", "test"))
    features, asked = (
        extract_features(extractor, seen.observations, seen.origin_px)
        for seen in (correct(by, known), correct(by, test))
    )
    truth, sun = np.asarray(known.truth), np.asarray(test.sun)

    def errors(given: Array) -> Array:
        model = parts.model(model_name).for_sensor(geometry, extractor.about.kind)
        pipeline = Pipeline(extractor, model)
        pipeline.fit_features(features, given, known.context)
        return angles_deg(pipeline.predict_features(asked, test.context), sun)

    on_bench, bench = [], []
    for _ in range(BENCHES):
        fixed = rng.standard_normal(8)
        random = rng.standard_normal((len(truth), 2))
        on_bench.append(mean_square(errors(reported(truth, fixed, random))))
        # a fit to hundreds of poses averages out what they err at random
        steady = reported(sun, fixed, np.zeros((len(sun), 2)))
        bench.append(mean_square(angles_deg(steady, sun)))
    return mean_square(errors(truth)), float(np.mean(on_bench)), float(np.mean(bench))


@pytest.mark.slow
def test_the_error_on_benches_is_the_root_of_the_squares_on_thirty_pipelines():
    wrong = {}
    pipelines = sampled(30)
    for pipeline in pipelines:
        own, on_bench, bench = on_drawn_benches(*pipeline)
        ratio = np.sqrt(on_bench / (own + bench))
        if abs(ratio - 1.0) > 0.05:
            wrong[pipeline] = ratio
    assert len(pipelines) == 30
    assert wrong == {}
