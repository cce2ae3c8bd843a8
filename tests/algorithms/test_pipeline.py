"""An extractor and a model together: checked where they meet, the same by either way in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

from algorithms.angles import sun_from_angles
from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    NotFittedError,
    Observation,
    SensorGeometry,
)
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.extractors.frames.centroid import BasicCentroid
from algorithms.models.geometric.least_squares import LeastSquaresGeometry
from algorithms.models.geometric.standard_projection import StandardProjection
from algorithms.pipeline import Pipeline, check_features, extract_features

DESIGN = SensorGeometry(focal_length_mm=0.3, pixel_pitch_mm=0.01, centre_px=(20.0, 16.0))


@dataclass(frozen=True)
class Given(Extractor):
    """Gives what it was given."""

    about: ClassVar = AboutExtractor(
        name="given", taxonomy="BCM", observation=Observation.FRAMES, kind=FeatureKind.SPOT
    )
    found: Any = None

    def extract(self, observations):
        return self.found


@pytest.fixture
def seen():
    """Frames (9, 12, 16) with one bright pixel each, their origins and the Suns behind them."""
    angles = np.array([[a, b] for a in (-8.0, 0.0, 8.0) for b in (-10.0, 0.0, 10.0)])
    sun = sun_from_angles(angles)
    spots = np.round(30 * sun[:, :2] / sun[:, 2:] + DESIGN.centre_px).astype(int)
    origins = spots - (7, 5)
    frames = np.zeros((9, 12, 16))
    frames[:, 5, 7] = 100.0
    exact = np.column_stack([(spots - DESIGN.centre_px)[:, :2] / 30, np.ones(9)])
    return frames, exact / np.linalg.norm(exact, axis=1, keepdims=True), origins


def test_it_finds_the_sun_in_windows_of_the_detector(seen):
    frames, sun, origins = seen
    pipeline = Pipeline.for_sensor(BasicCentroid, LeastSquaresGeometry, DESIGN)
    assert pipeline.fit(frames, sun, origins) is pipeline
    np.testing.assert_allclose(pipeline.predict(frames, origins), sun, atol=1e-9)
    dark = np.where(np.arange(9)[:, None, None] == 4, 0.0, frames)
    found = pipeline.predict(dark, origins)
    assert np.isnan(found[4]).all()
    np.testing.assert_array_equal(
        np.delete(found, 4, 0), pipeline.predict(frames, origins)[[0, 1, 2, 3, 5, 6, 7, 8]]
    )


def test_features_extracted_once_serve_every_model(seen):
    frames, sun, origins = seen
    whole = Pipeline.for_sensor(BasicCentroid, LeastSquaresGeometry, DESIGN).fit(*seen)
    features = extract_features(BasicCentroid(), frames, origins)
    np.testing.assert_array_equal(features, whole.features(frames, origins))
    apart = Pipeline(
        BasicCentroid(), LeastSquaresGeometry.for_sensor(DESIGN, FeatureKind.SPOT)
    ).fit_features(features, sun)
    np.testing.assert_array_equal(apart.predict_features(features), whole.predict(frames, origins))
    other = whole.with_model(StandardProjection.for_sensor(DESIGN, FeatureKind.SPOT))
    assert other.extractor is whole.extractor
    with pytest.raises(NotFittedError):
        other.predict_features(features)
    whole.predict_features(features)


def test_a_model_that_cannot_read_the_features_is_refused():
    with pytest.raises(ValueError, match=r"spm accepts .*balance.*spot.*direct gives signals"):
        Pipeline(DirectSignals(), StandardProjection(1.0, 0.01))


def test_a_row_is_found_or_not():
    given = np.array([[1.0, 2.0], [np.nan, 2.0], [3.0, np.inf], [np.nan, np.nan]])
    found = extract_features(Given(given), np.zeros(4))
    np.testing.assert_array_equal(found[0], [1.0, 2.0])
    assert np.isnan(found[1:]).all()
    assert given[1, 1] == 2.0, "what the extractor keeps is left alone"
    assert check_features(Given(), given[:1], 1) is not None


@pytest.mark.parametrize(
    "given",
    [np.zeros((3, 2)), np.zeros((4, 3)), np.zeros(4), np.zeros((4, 2), dtype=np.float32)],
)
def test_an_extractor_that_breaks_its_contract_is_named(given):
    with pytest.raises(ValueError, match=r"given.*float64.*\(4.*2\)"):
        extract_features(Given(given), np.zeros(4))
