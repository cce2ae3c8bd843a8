"""Data sets as experiments of claims use them: by unit, calibrated once, scored on the test split.

Four tilted diodes whose currents a least-squares model inverts: what it errs by is the noise.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from fake_atlas import Currents, Diodes, Gaps, LeastSquares

from algorithms.contract import FeatureKind
from benchmark.claims.benches import (
    ConditionView,
    draw,
    exponent,
    middles,
    rank_correlation,
    ratio,
    rms,
    rms_within,
    separation,
    times_s,
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


def test_incidence_is_the_angle_from_the_boresight(view: ConditionView) -> None:
    ahead = np.tile([0.0, 0.0, 1.0], (60, 1))
    np.testing.assert_allclose(
        view.incidence_deg(), separation(view.samples("test").sun, ahead), atol=1e-5
    )
    assert view.incidence_deg("calibration").max() < 25.0


def test_rings_and_masks_choose_the_errors_that_are_averaged() -> None:
    errors = np.array([3.0, 4.0, math.nan, 12.0])
    assert rms(errors) == pytest.approx(math.sqrt(169.0 / 3.0))
    assert rms(errors, [True, True, True, False]) == pytest.approx(math.sqrt(12.5))
    assert math.isnan(rms(errors, [False, False, True, False]))
    rings = rms_within(errors, np.array([0.0, 1.0, 2.0, 3.0]), [0.0, 2.0, 3.0, 4.0])
    assert rings == pytest.approx([math.sqrt(12.5), math.nan, 12.0], nan_ok=True)
    assert middles([0.0, 2.0, 3.0]) == [1.0, 2.5]


def test_a_ratio_needs_a_divisor() -> None:
    assert ratio(6.0, 3.0) == 2.0
    assert math.isnan(ratio(6.0, 0.0))
    assert math.isnan(ratio(6.0, math.nan))
    assert math.isnan(ratio(math.nan, 3.0))


def test_slopes_and_ranks_need_enough_points_that_are_numbers() -> None:
    places = np.array([1.0, 2.0, 4.0, 8.0, -1.0])
    assert exponent(places, np.abs(places) ** 1.5) == pytest.approx(1.5)
    assert math.isnan(exponent([1.0, 2.0], [3.0, math.nan]))
    assert rank_correlation([1.0, 2.0, 3.0, math.nan], [9.0, 4.0, 1.0, 0.0]) == pytest.approx(-1.0)
    assert math.isnan(rank_correlation([1.0, 2.0], [1.0, 2.0]))


def test_rows_are_drawn_once_each_in_their_order() -> None:
    rows = draw(np.arange(50), 20, np.random.default_rng(1))
    assert len(set(rows.tolist())) == 20
    assert (np.diff(rows) > 0).all()


def test_calls_are_timed_by_turns_after_one_that_does_not_count() -> None:
    made: list[str] = []
    found = times_s(one=lambda: made.append("one"), other=lambda: made.append("other"))
    assert made[:4] == ["one", "other"] * 2
    assert made.count("one") == made.count("other") > 2
    assert all(0.0 <= seconds < 1.0 for seconds in found.values())
