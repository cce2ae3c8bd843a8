"""What every model must do, check by check."""

from __future__ import annotations

import dataclasses
import json
import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from expectations import assert_documented, assert_metadata, assert_rejects, same, wrong_arrays
from shared_fits import learnt, learnt_again, witnessed

from algorithms.angles import separation_deg
from algorithms.calibration.saving import stage_document, stage_of
from algorithms.contract import (
    FeatureKind,
    Model,
    NotFittedError,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
    parameters,
)

MODEL_CHECKS: list[Callable[..., None]] = []


def assert_learns_nothing(model, cal):
    """A drawing holds everywhere, since no calibration changes it."""
    half = cal.of(slice(None, None, 2))
    _, whole = learnt(model, cal)
    again = model.fit(half.features, half.sun, half.context).predict(cal.features, cal.context)
    same(again, whole)
    assert model.quality_.parameters == ()
    assert not model.quality_.settings


def model_check(function):
    MODEL_CHECKS.append(function)
    return function


@model_check
def check_model_keeps_the_contract(cls, model, cal):
    assert isinstance(model, Model)
    assert_metadata(cls)
    assert cls.about.accepts
    assert all(kind in FeatureKind for kind in cls.about.accepts)


@model_check
def check_model_is_documented(cls, model, cal):
    assert_documented(cls)


@model_check
def check_fitted_attributes_appear_with_fit(cls, model, cal):
    fitted = [field.name for field in dataclasses.fields(model) if not field.init]
    assert fitted
    assert all(name.endswith("_") and not name.startswith("_") for name in fitted)
    assert not any(hasattr(model, name) for name in fitted)
    seen = witnessed(model, cal)
    before, after = seen.attributes
    assert not before & set(fitted)
    assert seen.returned is seen.model
    assert after >= set(fitted)
    assert repr(seen.model)


@model_check
def check_parameters_are_plain_and_kept(cls, model, cal):
    seen = witnessed(model, cal)
    before, after = seen.documents
    assert after == before == json.dumps(parameters(model), allow_nan=False)
    assert seen.model == model == cls(**parameters(model))


@model_check
def check_predict_before_fit_says_so(cls, model, cal):
    with pytest.raises(NotFittedError, match="fit"):
        model.predict(cal.features, cal.context)


@model_check
def check_predicts_unit_vectors(cls, model, cal):
    _, predicted = learnt(model, cal)
    assert predicted.shape == cal.sun.shape
    assert predicted.dtype == np.float64
    np.testing.assert_allclose(np.linalg.norm(predicted, axis=1), 1.0, atol=1e-14)


@model_check
def check_finds_the_suns_it_learnt(cls, model, cal):
    _, predicted = learnt(model, cal)
    error_deg = np.degrees(np.linalg.norm(predicted - cal.sun, axis=1))
    assert np.sqrt(np.mean(error_deg**2)) < 3.0  # a tenth of the field: right axes, right signs


@model_check
def check_nan_feature_rows_are_nan_predictions(cls, model, cal):
    model, whole = learnt(model, cal)
    at_a_time = len(cal.features) // 2
    for bad in (np.nan, np.inf, -np.inf):
        for first in range(0, cal.features.shape[1], at_a_time):
            columns = np.arange(first, min(first + at_a_time, cal.features.shape[1]))
            rows = 2 * (columns - first) + 1  # every column is broken in a row of its own
            broken = cal.features.copy()
            broken[rows, columns] = bad
            predicted = model.predict(broken, cal.context)
            assert np.isnan(predicted[rows]).all()
            same(np.delete(predicted, rows, axis=0), np.delete(whole, rows, axis=0))
    first = cal.of(slice(1))
    assert np.isnan(model.predict(np.full_like(first.features, np.nan), first.context)).all()


@model_check
def check_nan_feature_rows_are_left_out_of_the_fit(cls, model, cal):
    _, expected = learnt(model, cal)
    gaps = [0, 7, 7]
    features = np.insert(cal.features, gaps, np.nan, axis=0)
    sun = np.insert(cal.sun, gaps, [0.0, 0.0, 1.0], axis=0)
    context = {name: np.insert(column, gaps, 1.0, axis=0) for name, column in cal.context.items()}
    again = cls(**parameters(model)).fit(features, sun, context)
    same(again.predict(cal.features, cal.context), expected)


@model_check
def check_model_refuses_wrong_features(cls, model, cal):
    wrong = wrong_arrays(cal.features)
    wrong["a column more"] = np.hstack([cal.features, cal.features[:, :1]])
    assert_rejects(lambda features: model.fit(features, cal.sun, cal.context), wrong)
    model, _ = learnt(model, cal)
    assert_rejects(lambda features: model.predict(features, cal.context), wrong)


@model_check
def check_model_refuses_wrong_suns(cls, model, cal):
    wrong = wrong_arrays(cal.sun)
    wrong["one Sun short"] = cal.sun[1:]
    wrong["two columns"] = cal.sun[:, :2]
    assert_rejects(lambda sun: model.fit(cal.features, sun, cal.context), wrong)
    for unfit in (cal.sun * 1.01, np.where(np.arange(3) == 1, np.nan, cal.sun), 0 * cal.sun):
        with pytest.raises(ValueError, match="unit vectors"):
            model.fit(cal.features, unfit, cal.context)


@model_check
def check_data_that_do_not_settle_it_are_refused_by_their_own_error(cls, model, cal):
    """Nothing found, one sample, one pose again and again: refused, or enough for this model."""
    nothing = replace(cal, features=np.full_like(cal.features, np.nan))
    for calibration in (nothing, cal.of(slice(1)), cal.of(np.zeros(len(cal.features), dtype=int))):
        try:
            model.fit(calibration.features, calibration.sun, calibration.context)
        except UnusableDataError as refusal:
            assert model.about.name in str(refusal)  # noqa: PT017 - either outcome is right
        else:
            found = model.predict(cal.features, cal.context)
            assert (np.isnan(found).all(axis=1) | np.isfinite(found).all(axis=1)).all()


@model_check
def check_a_refused_fit_leaves_no_trace(cls, model, cal):
    with pytest.raises(ValueError, match="unit vectors"):
        model.fit(cal.features, 2 * cal.sun, cal.context)
    with pytest.raises(NotFittedError):
        model.predict(cal.features, cal.context)
    model, expected = learnt(model, cal)
    with pytest.raises(ValueError, match="unit vectors"):
        model.fit(cal.features, 2 * cal.sun, cal.context)
    same(model.predict(cal.features, cal.context), expected)


@model_check
def check_model_is_deterministic_and_forgets_the_fit_before(cls, model, cal):
    fitted, first = learnt(model, cal)
    same(fitted.predict(cal.features, cal.context), first)
    same(learnt_again(model, cal), first)


@model_check
def check_model_batch_of_one_equals_batch_of_many(cls, model, cal):
    model, together = learnt(model, cal)
    for stop in range(1, 20):
        for rows in (slice(stop - 1, stop), slice(stop)):
            part = cal.of(rows)
            same(model.predict(part.features, part.context), together[rows])


@model_check
def check_model_leaves_input_alone(cls, model, cal):
    given = witnessed(model, cal).given
    same(given.features, cal.features)
    same(given.sun, cal.sun)
    assert given.context.keys() == cal.context.keys()
    for name, column in given.context.items():
        same(column, cal.context[name])


@model_check
def check_model_layouts_and_dtypes_agree(cls, model, cal):
    model, expected = learnt(model, cal)
    readonly = np.array(cal.features, order="F")
    readonly.flags.writeable = False
    for features in (readonly, cal.features.tolist()):
        other = cls(**parameters(model)).fit(features, np.asfortranarray(cal.sun), cal.context)
        same(other.predict(features, cal.context), expected)
    third = cal.of(slice(None, None, 3))
    same(model.predict(third.features, third.context), expected[::3])
    single = cal.features.astype(np.float32)
    same(model.predict(single, cal.context), model.predict(single.astype(np.float64), cal.context))


@model_check
def check_model_survives_pickling(cls, model, cal):
    assert pickle.loads(pickle.dumps(model)) == model
    fitted, expected = learnt(model, cal)
    same(pickle.loads(pickle.dumps(fitted)).predict(cal.features, cal.context), expected)


@model_check
def check_refuses_other_kinds_and_names_missing_geometry(cls, model, cal, geometry):
    for kind in set(FeatureKind) - cls.about.accepts:
        with pytest.raises(UnsuitableDesignError, match="accepts"):
            cls.for_sensor(geometry, kind)
    for kind in cls.about.accepts:
        for name in cls.about.needs:
            with pytest.raises(UnsuitableDesignError, match=name):
                cls.for_sensor(SensorGeometry(), kind)


@model_check
def check_a_saved_fit_answers_to_the_last_bit(cls, model, cal):
    """As JSON's words: what a document says is all there is."""
    model, expected = learnt(model, cal)
    text = json.dumps(stage_document(model), allow_nan=False)
    again = stage_of(json.loads(text), {model.about.name: cls})
    assert again == model
    same(again.predict(cal.features, cal.context), expected)
    assert json.dumps(stage_document(again), allow_nan=False) == text


@model_check
def check_a_fit_says_how_good_it_is(cls, model, cal):
    model, found = learnt(model, cal)
    quality = model.quality_
    error = separation_deg(found, cal.sun)
    assert quality.samples == len(cal.features)
    assert quality.residual_rms_deg == pytest.approx(np.sqrt(np.mean(error**2)), abs=1e-9)
    assert len(quality.data_digest) == 32
    assert quality.condition is None or quality.condition >= 1
    for parameter in quality.parameters:
        assert np.isfinite((parameter.value, parameter.deviation)).all()
    rest = cal.of(slice(1, None))
    again = cls(**parameters(model)).fit(rest.features, rest.sun, rest.context)
    assert again.quality_.data_digest != quality.data_digest


@model_check
def check_a_direction_has_a_deviation(cls, model, cal):
    features = cal.features.copy()
    features[3] = np.nan
    model, _ = learnt(model, cal)
    deviations = model.deviation_deg(features, cal.context)
    assert deviations.shape == (len(features),)
    assert np.isnan(deviations[3])
    assert (np.delete(deviations, 3) >= 0).all()


@model_check
def check_answers_end_with_what_was_calibrated(cls, model, cal):
    """Calibrated on one half of the field, it says nothing of the middle of the other."""
    if not model.bounded:
        assert_learns_nothing(model, cal)
        return
    near, far = cal.sun[:, 0] > -0.02, cal.sun[:, 0] < -0.3
    half = cal.of(near)
    model.fit(half.features, half.sun, half.context)
    found = model.predict(cal.features, cal.context)
    assert np.isfinite(found[near]).all()
    assert np.isnan(found[far]).all()
    anywhere = cls(**{**parameters(model), "extrapolation": float("inf")})
    anywhere.fit(half.features, half.sun, half.context)
    assert np.isfinite(anywhere.predict(cal.features, cal.context)[far]).any()


@model_check
def check_one_run_of_the_turntable_is_refused(cls, model, cal):
    if not model.bounded:
        assert_learns_nothing(model, cal)
        return
    run = cal.of(np.abs(cal.sun[:, 1]) < 1e-12)  # alpha = 0
    assert 5 < len(run.sun) < 30
    with pytest.raises(UnusableDataError, match=model.about.name):
        model.fit(run.features, run.sun, run.context)


@model_check
def check_suns_that_do_not_belong_to_the_features_are_refused(cls, model, cal):
    """Rows in another order; swapped axes, unless the model finds out itself."""
    if not model.bounded:
        assert_learns_nothing(model, cal)
        return
    cal = cal.of(slice(None, None, 4))  # readings that no model fits cost more than others
    shuffled = np.random.default_rng(2).permutation(len(cal.sun))
    with pytest.raises(UnusableDataError, match=model.about.name):
        model.fit(cal.features, cal.sun[shuffled], cal.context)
    swapped = cal.sun[:, [1, 0, 2]]
    try:
        model.fit(cal.features, swapped, cal.context)
    except UnusableDataError as refusal:
        assert model.about.name in str(refusal)  # noqa: PT017 - either outcome is right
    else:
        error = separation_deg(model.predict(cal.features, cal.context), swapped)
        assert np.sqrt(np.nanmean(error**2)) < 1.0


@model_check
def check_repeats_of_poses_count_once(cls, model, cal):
    """All poses taken three times tell of directions what one time does."""
    model, once = learnt(model, cal)
    thrice, often = cls(**parameters(model)), cal.of(np.repeat(np.arange(len(cal.sun)), 3))
    thrice.fit(often.features, often.sun, often.context)
    assert np.nanmax(separation_deg(thrice.predict(cal.features, cal.context), once)) < 1e-3


@model_check
def check_context_that_is_not_read_is_not_looked_at(cls, model, cal):
    if model.about.context:
        with pytest.raises(ValueError, match=model.about.context[0]):
            model.fit(cal.features, cal.sun)
        with pytest.raises(ValueError, match=model.about.context[0]):
            learnt(model, cal)[0].predict(cal.features)
        with pytest.raises(ValueError, match=model.about.context[0]):
            model.fit(cal.features, cal.sun, {f"{model.about.context[0]}s": cal.sun[:, 0]})
        return
    _, expected = learnt(model, cal)
    beside = {"time_s": "now", "anything": None}
    same(model.fit(cal.features, cal.sun, beside).predict(cal.features, beside), expected)
    with pytest.raises(ValueError, match="context"):
        model.fit(cal.features, cal.sun, [1.0])
