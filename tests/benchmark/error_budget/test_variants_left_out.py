"""Variants of an error budget that a chain does not have: no references, no lamp, a refused fit."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
import pytest
from fake_atlas import Choosy, Currents, LeastSquares

from algorithms.contract import (
    AboutExtractor,
    AboutModel,
    Extractor,
    FeatureKind,
    Observation,
    SensorGeometry,
    UnusableDataError,
)
from benchmark import datasets
from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Preset
from benchmark.error_budget import measure, perfected
from benchmark.error_budget.measure import directions, score_variants
from benchmark.error_budget.variants import VARIANTS
from benchmark.simulator.sensors.black_sun import BlackSunSensor


@dataclass(frozen=True)
class Brightest(Extractor):
    """The middle of all pixels brighter than half of the brightest."""

    about: ClassVar = AboutExtractor(
        name="fake-brightest",
        taxonomy="BCM",
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )
    features: ClassVar = ("x_px", "y_px")

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Any:
        return cls()

    def extract(self, observations: Any) -> Any:
        frames = np.asarray(observations, dtype=np.float64)
        bright = frames > 0.5 * frames.max(axis=(1, 2), keepdims=True)
        places = [np.argwhere(one).mean(axis=0)[::-1] for one in bright]
        return np.array(places)


@dataclass
class Affine:
    """Tangents as a linear function of the place of the spot."""

    about: ClassVar = AboutModel(
        name="fake-affine", taxonomy="LSQ", accepts=frozenset({FeatureKind.SPOT})
    )
    slopes_: Any = field(default=None, init=False)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Any:
        return cls()

    def fit(self, features: Any, sun: Any, context: Any = None) -> Any:
        known = np.column_stack([np.ones(len(features)), features])
        wanted = np.asarray(sun)[:, :2] / np.asarray(sun)[:, 2:]
        self.slopes_ = np.linalg.lstsq(known, wanted, rcond=None)[0]
        return self

    def predict(self, features: Any, context: Any = None) -> Any:
        known = np.column_stack([np.ones(len(features)), features])
        vectors = np.column_stack([known @ self.slopes_, np.ones(len(features))])
        return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


@pytest.fixture(scope="module")
def pyramid() -> Preset:
    preset = datasets.get("pd-maskless-pyramid")
    assert isinstance(preset, Preset)
    return replace(preset, directions=ConeField(55.0, 30, 20))


def without(found: measure.VariantErrors) -> set[str]:
    assert found.errors_deg.keys() == set(VARIANTS)
    return {name for name, error in found.errors_deg.items() if error is None}


def test_samples_whose_direction_is_not_observable_are_not_judged(
    pyramid: Preset, monkeypatch: pytest.MonkeyPatch
) -> None:
    every = score_variants(pyramid, "nominal", Currents, LeastSquares, all_observable=True)
    assert every.judged == 20
    assert without(every) == {"surroundings", "places", "places_dense"}
    bound = pyramid.bound("nominal", "test")
    dark = replace(bound, observable=np.arange(20) % 2 == 0)
    monkeypatch.setattr(Preset, "bound", lambda *_: dark)
    assert score_variants(pyramid, "nominal", Currents, LeastSquares).judged == 10


def test_a_model_that_refuses_the_calibration_has_no_budget_and_no_directions(
    pyramid: Preset,
) -> None:
    with pytest.raises(UnusableDataError, match="refuses the calibration as it is"):
        score_variants(pyramid, "nominal", Currents, Choosy, all_observable=True)
    sun, found = directions(pyramid, "nominal", Currents, Choosy)
    assert sun.shape == (20, 3)
    assert found == {}


def test_a_model_that_refuses_what_a_bench_says_has_no_error_on_benches(pyramid: Preset) -> None:
    known = {split: pyramid.generate("nominal", split).truth for split in ("calibration", "test")}
    truths = [known["calibration"], np.concatenate(list(known.values()))]

    class Truthful(LeastSquares):
        def fit(self, features: Any, sun: Any, context: Any = None) -> Any:
            if not any(np.array_equal(sun, one) for one in truths):
                raise UnusableDataError("these are not the true directions")
            return super().fit(features, sun, context)

    found = score_variants(pyramid, "nominal", Currents, Truthful, all_observable=True)
    assert without(found) == {"bench", "surroundings", "places", "places_dense"}


def test_a_lens_camera_on_a_perfect_bench_has_neither_references_nor_a_lamp() -> None:
    preset = datasets.get("ccd-lens")
    assert isinstance(preset, Preset)
    setup = replace(preset.condition("nominal"), bench=None)
    small = replace(
        preset, directions=AngleField(10.0, 3, 4), setups={**preset.setups, "nominal": setup}
    )
    found = score_variants(small, "nominal", Brightest, Affine, all_observable=True)
    missing = {"lamp", "references", "uncorrected", "surroundings"}
    assert without(found) == missing
    assert found.judged == 4
    assert found.errors_deg["bench"] == found.errors_deg["as_is"], "a perfect bench says the truth"
    places, perfect = (found.errors_deg[name] for name in ("places", "perfect"))
    assert places is not None
    assert perfect is not None
    assert 0.0 < places < 0.5 * perfect, "blooming moves the spots that are found"


def test_the_place_behind_a_lens_is_the_image_of_the_sun_s_centre() -> None:
    preset = datasets.get("cmos-lens")
    sensor = preset.condition("nominal").sensor
    assert isinstance(sensor, BlackSunSensor)
    sun = preset.scene("nominal", "test").sun
    found = np.zeros((len(sun), 2))
    found[3] = np.nan
    places = perfected.true_features(preset, "nominal", FeatureKind.SPOT, sun, found)
    assert places is not None
    assert np.isnan(places[3]).all()
    seen = np.arange(len(sun)) != 3
    np.testing.assert_allclose(sensor.camera.sun_of(places[seen]), sun[seen], atol=1e-12)
