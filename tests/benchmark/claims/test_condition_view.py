"""Data sets as experiments of claims use them: by unit, calibrated once, scored on the test split.

Four tilted diodes whose currents a least-squares model inverts: what it errs by is the noise.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from fake_atlas import Currents, Diodes, Gaps, LeastSquares

from algorithms.contract import FeatureKind
from benchmark.claims.benches import (
    ConditionView,
    rms,
)


@pytest.fixture(scope="module")
def view() -> ConditionView:
    return ConditionView(Diodes(n=60), "noisy")


def test_a_model_errs_by_the_noise_and_a_class_is_as_an_instance_made_for_the_sensor(
    view: ConditionView,
) -> None:
    errors = view.errors(Currents, LeastSquares)
    assert 0.3 < rms(errors) / rms(view.preset.bound("noisy").angle_deg) < 2.0
    made = LeastSquares.for_sensor(view.preset.geometry, FeatureKind.SIGNALS)
    np.testing.assert_array_equal(view.errors(Currents, made), errors)
    assert made.matrix_ is not None


def test_what_an_extractor_does_not_find_is_no_error(view: ConditionView) -> None:
    errors = view.errors(Gaps, LeastSquares)
    assert np.isnan(errors[::4]).all()
    np.testing.assert_array_equal(np.isfinite(errors), np.arange(60) % 4 > 0)
    pipeline = view.calibrate(Currents, LeastSquares)
    np.testing.assert_array_equal(
        view.errors_of(pipeline, Gaps)[1::4], view.errors(Currents, LeastSquares)[1::4]
    )


def test_splits_and_features_are_made_once(log: Callable[[], list[str]]) -> None:
    view = ConditionView(Diodes(n=20), "quiet", unit=3)
    for _ in range(2):
        view.errors(Currents, LeastSquares)
    made = [line for line in log() if line.startswith("generate")]
    assert made == [f"generate fake-diodes quiet {one} unit 3" for one in ("calibration", "test")]
    assert view.samples("test").sun.shape == (20, 3)
