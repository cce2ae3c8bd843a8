"""Features of corrected readings: the same in parts as at once, and as the runner finds them."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets import features
from benchmark.datasets.corrected import correct, correction
from benchmark.plan.parts import installed_parts
from benchmark.running.condition_data import generate
from benchmark.running.readings import found_features

CASES = [("ccd-slit", "eigen-analysis"), ("qpd-single-aperture", "voltage-balance")]


@pytest.mark.parametrize(("dataset", "name"), CASES)
def test_they_are_those_that_the_runner_scores(dataset: str, name: str) -> None:
    preset = datasets.get(dataset)
    extractor = installed_parts().extractor(name).for_sensor(preset.geometry)
    samples, by = preset.generate("nominal", "test"), correction(preset, "nominal")
    found = features.features_of(extractor, samples, by)
    scored = found_features(generate(preset, "nominal", all_observable=True), extractor, "test")
    np.testing.assert_array_equal(found, scored)
    uncorrected = features.features_of(extractor, samples)
    assert np.isfinite(uncorrected).any()
    assert not np.array_equal(uncorrected, found)
    ready = features.features_of(extractor, correct(by, samples))
    np.testing.assert_array_equal(ready, found)


def test_windows_in_parts_give_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    preset = datasets.get("cmos-single-aperture")
    extractor = installed_parts().extractor("weighted-spots").for_sensor(preset.geometry)
    samples, by = preset.generate("nominal", "test", 5), correction(preset, "nominal")
    whole = features.features_of(extractor, samples, by)
    monkeypatch.setattr(features, "_LARGE_BYTES", 0)
    monkeypatch.setattr(features, "_PART_BYTES", 8 * samples.observations[:3].size)
    np.testing.assert_array_equal(features.features_of(extractor, samples, by), whole)
