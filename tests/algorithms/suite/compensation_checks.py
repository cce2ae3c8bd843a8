"""What every compensation must do, check by check."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import pickle
from collections.abc import Callable

import numpy as np
import pytest
from expectations import assert_documented, assert_metadata, assert_rejects, same, wrong_arrays

from algorithms.calibration.saving import stage_document, stage_of
from algorithms.contract import (
    Compensation,
    FeatureKind,
    NotFittedError,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
    parameters,
)

COMPENSATION_CHECKS: list[Callable[..., None]] = []


def compensation_check(function):
    COMPENSATION_CHECKS.append(function)
    return function


def fitted(stage, cal):
    return stage.fit(cal.features, cal.sun, cal.context)


@compensation_check
def check_compensation_keeps_the_contract(cls, stage, cal):
    assert isinstance(stage, Compensation)
    assert_metadata(cls)
    assert all(kind in FeatureKind for kind in cls.about.accepts)
    assert_documented(cls)


@compensation_check
def check_features_stay_features(cls, stage, cal):
    found = fitted(stage, cal).transform(cal.features, cal.context)
    assert found.shape == cal.features.shape
    assert found.dtype == np.float64
    assert np.isfinite(found).all(axis=1).mean() > 0.5


@compensation_check
def check_fitted_attributes_appear_with_fit(cls, stage, cal):
    names = [field.name for field in dataclasses.fields(stage) if not field.init]
    assert names
    assert all(name.endswith("_") and not name.startswith("_") for name in names)
    assert not any(hasattr(stage, name) for name in names)
    with pytest.raises(NotFittedError, match="fit"):
        stage.transform(cal.features, cal.context)
    assert fitted(stage, cal) is stage
    assert all(hasattr(stage, name) for name in names)
    assert stage.samples_ == len(cal.features)


@compensation_check
def check_nan_feature_rows_are_nan_and_left_out(cls, stage, cal):
    whole = fitted(stage, cal).transform(cal.features, cal.context)
    broken = cal.features.copy()
    broken[4] = [np.nan, *broken[4, 1:]]
    found = stage.transform(broken, cal.context)
    assert np.isnan(found[4]).all()
    same(np.delete(found, 4, axis=0), np.delete(whole, 4, axis=0))
    places = np.insert(np.arange(len(cal.features)), [0, 7], 3)
    features, sun = cal.features[places], cal.sun[places]
    features[[0, 8]] = np.nan
    context = {name: column[places] for name, column in cal.context.items()}
    other = cls(**parameters(stage)).fit(features, sun, context)
    same(other.transform(cal.features, cal.context), whole)


@compensation_check
def check_wrong_input_is_refused(cls, stage, cal):
    wrong = wrong_arrays(cal.features)
    wrong["a column more"] = np.hstack([cal.features, cal.features[:, :1]])
    assert_rejects(lambda features: stage.fit(features, cal.sun, cal.context), wrong)
    assert_rejects(lambda sun: stage.fit(cal.features, sun, cal.context), wrong_arrays(cal.sun))
    fitted(stage, cal)
    assert_rejects(lambda features: stage.transform(features, cal.context), wrong)


@compensation_check
def check_context_is_asked_for_by_name(cls, stage, cal):
    beside = {name: cal.context[name] for name in cls.about.context}
    expected = fitted(stage, cal).transform(cal.features, cal.context)
    same(stage.fit(cal.features, cal.sun, beside).transform(cal.features, beside), expected)
    for name in cls.about.context:
        less = {key: column for key, column in beside.items() if key != name}
        with pytest.raises(ValueError, match=name):
            stage.fit(cal.features, cal.sun, less)
        with pytest.raises(ValueError, match=name):
            stage.transform(cal.features, {**less, f"{name}s": beside[name]})
        with pytest.raises(ValueError, match=name):
            stage.transform(cal.features, {**beside, name: beside[name][1:]})
        missing = {**beside, name: beside[name].copy()}
        missing[name][5] = np.nan
        assert np.isnan(stage.transform(cal.features, missing)[5]).all()


@compensation_check
def check_nothing_found_is_refused_and_leaves_no_trace(cls, stage, cal):
    nothing = np.full_like(cal.features, np.nan)
    with pytest.raises(UnusableDataError, match=stage.about.name):
        stage.fit(nothing, cal.sun, cal.context)
    with pytest.raises(NotFittedError):
        stage.transform(cal.features, cal.context)
    expected = fitted(stage, cal).transform(cal.features, cal.context)
    with pytest.raises(UnusableDataError, match=stage.about.name):
        stage.fit(nothing, cal.sun, cal.context)
    same(stage.transform(cal.features, cal.context), expected)


@compensation_check
def check_fits_are_independent_and_rows_too(cls, stage, cal):
    expected = fitted(stage, cal).transform(cal.features, cal.context)
    other = cls(**parameters(stage))
    half = {name: column[::2] for name, column in cal.context.items()}
    with contextlib.suppress(UnusableDataError):
        other.fit(cal.features[::2], cal.sun[::2], half)
    same(fitted(other, cal).transform(cal.features, cal.context), expected)
    for stop in range(1, 12):
        rows = slice(stop - 1, stop + 3)
        part = {name: column[rows] for name, column in cal.context.items()}
        same(stage.transform(cal.features[rows], part), expected[rows])
    same(pickle.loads(pickle.dumps(stage)).transform(cal.features, cal.context), expected)


@compensation_check
def check_input_is_left_alone_and_parameters_are_plain(cls, stage, cal):
    features, sun = cal.features.copy(), cal.sun.copy()
    before = json.dumps(parameters(stage), allow_nan=False)
    stage.fit(features, sun, cal.context).transform(features, cal.context)
    same(features, cal.features)
    same(sun, cal.sun)
    assert json.dumps(parameters(stage), allow_nan=False) == before
    assert stage == cls(**parameters(stage))


@compensation_check
def check_a_saved_compensation_gives_the_same_bits(cls, stage, cal):
    expected = fitted(stage, cal).transform(cal.features, cal.context)
    text = json.dumps(stage_document(stage), allow_nan=False)
    again = stage_of(json.loads(text), {cls.about.name: cls})
    same(again.transform(cal.features, cal.context), expected)


@compensation_check
def check_refuses_other_kinds_and_names_missing_geometry(cls, stage, cal, geometry):
    for kind in set(FeatureKind) - cls.about.accepts:
        with pytest.raises(UnsuitableDesignError, match="accepts"):
            cls.for_sensor(geometry, kind)
    for kind in cls.about.accepts:
        for name in cls.about.needs:
            with pytest.raises(UnsuitableDesignError, match=name):
                cls.for_sensor(SensorGeometry(), kind)
