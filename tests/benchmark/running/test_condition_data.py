"""Data as extractors get them: corrected at once or some samples at a time, bounds beside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from fake_atlas import Currents, Diodes, FakeBound, FakeSamples

from algorithms.references import ReferenceCorrection
from benchmark import datasets
from benchmark.datasets import features
from benchmark.datasets.corrected import correct, correction
from benchmark.plan.parts import installed_parts
from benchmark.running import condition_data, readings
from benchmark.running.condition_data import generate
from benchmark.running.readings import found_features
from benchmark.running.stages import ConditionData, RenderedData

BY = ReferenceCorrection(np.array([1.0, 2.0, 3.0, 4.0]), np.array([11.0, 32.0, 13.0, 24.0]))
READ = np.arange(40.0).reshape(10, 4) + 20.0


def read(by: ReferenceCorrection | None = None) -> ConditionData:
    splits: Any = {"test": FakeSamples(READ.copy(), np.zeros((10, 3)))}
    seen = np.ones(10, dtype=np.bool_)
    preset: Any = Diodes()
    return ConditionData(
        preset, splits, None, None, seen, (), corrections={"test": by} if by else {}
    )


@dataclass(frozen=True)
class Counting(Currents):
    """Says how many samples it is given at a time."""

    given: tuple[Any, ...] = ([],)

    def extract(self, observations: Any) -> Any:
        self.given[0].append(len(observations))
        return super().extract(observations)


@pytest.mark.parametrize(("samples", "sizes"), [(3, [3, 3, 3, 1]), (0.5, [1] * 10), (99, [10])])
def test_samples_corrected_some_at_a_time_give_the_features_of_all(
    samples: float, sizes: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(readings, "_BATCH_BYTES", int(samples * READ[0].nbytes))
    extractor: Any = Counting(given=([],))
    found = readings.found_features(read(BY), extractor, "test")
    assert extractor.given[0] == sizes
    np.testing.assert_array_equal(found, BY.correct(READ))


@pytest.mark.parametrize(("limit", "later"), [(READ.nbytes, False), (READ.nbytes - 1, True)])
def test_readings_are_corrected_at_once_where_memory_allows(
    limit: int, later: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(readings, "_CORRECTED_BYTES", limit)
    preset: Any = Diodes()
    data = readings.correct_readings(RenderedData(read(), {"test": BY}), preset)
    observations = np.asarray(data.splits["test"].observations)
    np.testing.assert_array_equal(observations, READ if later else BY.correct(READ))
    assert data.corrections == ({"test": BY} if later else {})
    assert not observations.flags.writeable


def test_bounds_of_who_does_not_know_the_unit_stand_where_there_are_any() -> None:
    class Known(Diodes):
        def bound(self, condition: str, split: str = "test", n: int | None = None) -> FakeBound:
            bound = super().bound(condition, split, n)
            return FakeBound(bound.angle_deg, bound.observable)

    def rendered(preset: Any) -> ConditionData:
        return condition_data.render(preset, "quiet", 0, all_observable=False).data

    data = rendered(Diodes(n=40, unit_share=1.5))
    assert data.bound_deg is not None
    np.testing.assert_array_equal(data.bound_unit_deg, 1.5 * data.bound_deg)
    assert rendered(Known(n=40)).bound_unit_deg is None


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


@pytest.mark.slow
def test_windows_in_parts_give_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    preset = datasets.get("cmos-single-aperture")
    extractor = installed_parts().extractor("weighted-spots").for_sensor(preset.geometry)
    samples, by = preset.generate("nominal", "test", 5), correction(preset, "nominal")
    whole = features.features_of(extractor, samples, by)
    monkeypatch.setattr(features, "_LARGE_BYTES", 0)
    monkeypatch.setattr(features, "_PART_BYTES", 8 * samples.observations[:3].size)
    np.testing.assert_array_equal(features.features_of(extractor, samples, by), whole)
