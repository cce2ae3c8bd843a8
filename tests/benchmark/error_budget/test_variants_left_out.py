"""Variants of an error budget that a chain does not have: no references, no lamp, a refused fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fake_atlas import Currents, LeastSquares

from algorithms.contract import (
    FeatureKind,
)
from benchmark import datasets
from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.preset import Preset
from benchmark.error_budget import measure, perfected
from benchmark.error_budget.measure import score_variants
from benchmark.error_budget.variants import VARIANTS
from benchmark.simulator.sensors.black_sun import BlackSunSensor


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
