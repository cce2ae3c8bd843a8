"""What every model must do, check by check."""

from __future__ import annotations

import dataclasses
import json
import pickle
from collections.abc import Callable

import numpy as np
import pytest
from expectations import assert_documented, assert_metadata, assert_rejects, same, wrong_arrays

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
    assert model.fit(cal.features, cal.sun) is model
    assert all(hasattr(model, name) for name in fitted)
    assert repr(model)


@model_check
def check_parameters_are_plain_and_kept(cls, model, cal):
    before = json.dumps(parameters(model), allow_nan=False)
    model.fit(cal.features, cal.sun)
    model.predict(cal.features)
    assert json.dumps(parameters(model), allow_nan=False) == before
    assert model == cls(**parameters(model))


@model_check
def check_predict_before_fit_says_so(cls, model, cal):
    with pytest.raises(NotFittedError, match="fit"):
        model.predict(cal.features)


@model_check
def check_predicts_unit_vectors(cls, model, cal):
    predicted = model.fit(cal.features, cal.sun).predict(cal.features)
    assert predicted.shape == cal.sun.shape
    assert predicted.dtype == np.float64
    np.testing.assert_allclose(np.linalg.norm(predicted, axis=1), 1.0, atol=1e-14)


@model_check
def check_finds_the_suns_it_learnt(cls, model, cal):
    predicted = model.fit(cal.features, cal.sun).predict(cal.features)
    error_deg = np.degrees(np.linalg.norm(predicted - cal.sun, axis=1))
    assert np.sqrt(np.mean(error_deg**2)) < 3.0  # a tenth of the field: right axes, right signs


@model_check
def check_nan_feature_rows_are_nan_predictions(cls, model, cal):
    whole = model.fit(cal.features, cal.sun).predict(cal.features)
    for bad in (np.nan, np.inf, -np.inf):
        for column in range(cal.features.shape[1]):
            broken = cal.features.copy()
            broken[4, column] = bad
            predicted = model.predict(broken)
            assert np.isnan(predicted[4]).all()
            same(np.delete(predicted, 4, axis=0), np.delete(whole, 4, axis=0))
    assert np.isnan(model.predict(np.full_like(cal.features[:1], np.nan))).all()


@model_check
def check_nan_feature_rows_are_left_out_of_the_fit(cls, model, cal):
    expected = model.fit(cal.features, cal.sun).predict(cal.features)
    features = np.insert(cal.features, [0, 7, 7], np.nan, axis=0)
    sun = np.insert(cal.sun, [0, 7, 7], [0.0, 0.0, 1.0], axis=0)
    same(cls(**parameters(model)).fit(features, sun).predict(cal.features), expected)


@model_check
def check_model_refuses_wrong_features(cls, model, cal):
    wrong = wrong_arrays(cal.features)
    wrong["a column more"] = np.hstack([cal.features, cal.features[:, :1]])
    assert_rejects(lambda features: model.fit(features, cal.sun), wrong)
    model.fit(cal.features, cal.sun)
    assert_rejects(model.predict, wrong)


@model_check
def check_model_refuses_wrong_suns(cls, model, cal):
    wrong = wrong_arrays(cal.sun)
    wrong["one Sun short"] = cal.sun[1:]
    wrong["two columns"] = cal.sun[:, :2]
    assert_rejects(lambda sun: model.fit(cal.features, sun), wrong)
    for unfit in (cal.sun * 1.01, np.where(np.arange(3) == 1, np.nan, cal.sun), 0 * cal.sun):
        with pytest.raises(ValueError, match="unit vectors"):
            model.fit(cal.features, unfit)


@model_check
def check_data_that_do_not_settle_it_are_refused_by_their_own_error(cls, model, cal):
    """Nothing found, one sample, one pose again and again: refused, or enough for this model."""
    places = np.zeros(len(cal.features), dtype=int)
    for features, sun in (
        (np.full_like(cal.features, np.nan), cal.sun),
        (cal.features[:1], cal.sun[:1]),
        (cal.features[places], cal.sun[places]),
    ):
        try:
            model.fit(features, sun)
        except UnusableDataError as refusal:
            assert model.about.name in str(refusal)  # noqa: PT017 - either outcome is right
        else:
            found = model.predict(cal.features)
            assert (np.isnan(found).all(axis=1) | np.isfinite(found).all(axis=1)).all()


@model_check
def check_a_refused_fit_leaves_no_trace(cls, model, cal):
    with pytest.raises(ValueError, match="unit vectors"):
        model.fit(cal.features, 2 * cal.sun)
    with pytest.raises(NotFittedError):
        model.predict(cal.features)
    expected = model.fit(cal.features, cal.sun).predict(cal.features)
    with pytest.raises(ValueError, match="unit vectors"):
        model.fit(cal.features, 2 * cal.sun)
    same(model.predict(cal.features), expected)


@model_check
def check_model_is_deterministic(cls, model, cal):
    first = model.fit(cal.features, cal.sun).predict(cal.features)
    same(model.predict(cal.features), first)
    same(cls(**parameters(model)).fit(cal.features, cal.sun).predict(cal.features), first)


@model_check
def check_fit_forgets_the_fit_before(cls, model, cal):
    expected = model.fit(cal.features, cal.sun).predict(cal.features)
    other = cls(**parameters(model)).fit(cal.features[::2], cal.sun[::2])
    same(other.fit(cal.features, cal.sun).predict(cal.features), expected)


@model_check
def check_model_batch_of_one_equals_batch_of_many(cls, model, cal):
    together = model.fit(cal.features, cal.sun).predict(cal.features)
    for stop in range(1, 20):
        same(model.predict(cal.features[stop - 1 : stop]), together[stop - 1 : stop])
        same(model.predict(cal.features[:stop]), together[:stop])


@model_check
def check_model_leaves_input_alone(cls, model, cal):
    features, sun = cal.features.copy(), cal.sun.copy()
    model.fit(features, sun).predict(features)
    same(features, cal.features)
    same(sun, cal.sun)


@model_check
def check_model_layouts_and_dtypes_agree(cls, model, cal):
    expected = model.fit(cal.features, cal.sun).predict(cal.features)
    readonly = cal.features.copy()
    readonly.flags.writeable = False
    for features in (np.asfortranarray(cal.features), readonly, cal.features.tolist()):
        other = cls(**parameters(model)).fit(features, np.asfortranarray(cal.sun))
        same(other.predict(features), expected)
    same(model.predict(cal.features[::3]), expected[::3])
    single = cal.features.astype(np.float32)
    same(model.predict(single), model.predict(single.astype(np.float64)))


@model_check
def check_model_survives_pickling(cls, model, cal):
    again = pickle.loads(pickle.dumps(model))
    assert again == model
    expected = model.fit(cal.features, cal.sun).predict(cal.features)
    same(again.fit(cal.features, cal.sun).predict(cal.features), expected)
    same(pickle.loads(pickle.dumps(model)).predict(cal.features), expected)


@model_check
def check_refuses_other_kinds_and_names_missing_geometry(cls, model, cal, geometry):
    for kind in set(FeatureKind) - cls.about.accepts:
        with pytest.raises(UnsuitableDesignError, match="accepts"):
            cls.for_sensor(geometry, kind)
    for kind in cls.about.accepts:
        for name in cls.about.needs:
            with pytest.raises(UnsuitableDesignError, match=name):
                cls.for_sensor(SensorGeometry(), kind)
