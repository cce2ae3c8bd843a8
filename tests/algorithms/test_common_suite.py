"""What every extractor and every model must do, run on all that discovery finds."""

from __future__ import annotations

import dataclasses
import json
import os
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import algorithms
from algorithms.contract import (
    Extractor,
    FeatureKind,
    Model,
    NotFittedError,
    Observation,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
    parameters,
)
from algorithms.discovery import discover_extractors, discover_models

EXTRACTORS = discover_extractors()
MODELS = discover_models()

EXTRACTOR_CHECKS: list[Callable[..., None]] = []
MODEL_CHECKS: list[Callable[..., None]] = []

RAN: set[tuple[str, str]] = set()


def extractor_check(function):
    EXTRACTOR_CHECKS.append(function)
    return function


def model_check(function):
    MODEL_CHECKS.append(function)
    return function


def same(first, second) -> None:
    """Equal to the last bit, NaN where NaN."""
    np.testing.assert_array_equal(first, second, strict=True)


def assert_metadata(implementation: Any) -> None:
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", implementation.about.name)
    assert implementation.about.taxonomy
    assert implementation.about.origin in {"survey", "ours"}
    assert isinstance(implementation.about.version, int)
    assert implementation.about.version >= 1
    fields = {field.name for field in dataclasses.fields(SensorGeometry)}
    assert set(implementation.about.needs) <= fields
    if implementation.about.origin == "survey":
        assert implementation.about.studies
        assert implementation.about.labels
    for key in implementation.about.studies:
        assert re.fullmatch(r"[A-Za-z]+\d{4}[a-z]?", key)
    for label in implementation.about.labels:
        assert re.fullmatch(r"(fe|model|alg|eq):[A-Za-z0-9]+", label)


def assert_documented(implementation: Any) -> None:
    text = implementation.__doc__
    for section in ("Implements:", "Shapes:", "Failure:", "Cost:"):
        assert section in text, f"{section} is missing"
    opening = text.split("Parameters\n")[0].split("Notes\n")[0]
    assert opening.count(". ") + opening.count(".\n") >= 2, "two sentences of what it does"
    for mentioned in (*implementation.about.studies, *implementation.about.labels):
        assert mentioned in text, f"{mentioned} is not cited"
    for field in dataclasses.fields(implementation):
        assert re.search(rf"\b{field.name}\b", text) or not field.init, f"{field.name} is missing"


def assert_rejects(call: Callable[[Any], Any], wrong: dict[str, Any]) -> None:
    for what, value in wrong.items():
        with pytest.raises(ValueError, match=r"got|hold|must not be empty") as refusal:
            call(value)
        assert not isinstance(refusal.value, UnusableDataError), f"{what} is the caller's mistake"
        assert len(str(refusal.value)) < 400, what


def wrong_arrays(right: np.ndarray) -> dict[str, Any]:
    return {
        "one dimension too few": right[0],
        "one dimension too many": right[None],
        "a scalar": 3.0,
        "no samples": right[:0],
        "empty samples": right[..., :0],
        "strings": right.astype(str),
        "objects": right.astype(object),
        "complex numbers": right.astype(complex),
        "a mask": np.ma.masked_equal(right, right.ravel()[0]),
        "a ragged list": [[1.0, 2.0], [3.0]],
        "None": None,
    }


# Extractors


@extractor_check
def check_keeps_the_contract(cls, extractor, observations):
    assert isinstance(extractor, Extractor)
    assert_metadata(cls)
    assert cls.about.observation in Observation
    assert cls.about.kind in FeatureKind
    names = extractor.features
    assert isinstance(names, tuple)
    assert len(set(names)) == len(names) > 0


@extractor_check
def check_is_documented(cls, extractor, observations):
    assert_documented(cls)


@extractor_check
def check_parameters_are_frozen_and_plain(cls, extractor, observations):
    assert hash(extractor) == hash(cls(**parameters(extractor)))
    json.dumps(parameters(extractor), allow_nan=False)
    for name, value in parameters(extractor).items():
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(extractor, name, value)


@extractor_check
def check_gives_one_float_row_a_sample(cls, extractor, observations):
    found = extractor.extract(observations)
    assert found.shape == (len(observations), len(extractor.features))
    assert found.dtype == np.float64
    assert np.isfinite(found).all()


@extractor_check
def check_dark_samples_are_nan_rows(cls, extractor, observations):
    dark = observations.copy()
    dark[3] = 0
    found = extractor.extract(dark)
    assert np.isnan(found[3]).all()
    same(np.delete(found, 3, axis=0), np.delete(extractor.extract(observations), 3, axis=0))
    assert np.isnan(extractor.extract(np.zeros_like(observations))).all()


@extractor_check
def check_samples_with_nan_or_infinity_are_nan_rows(cls, extractor, observations):
    real = observations.astype(np.float64)
    whole = extractor.extract(real)
    for bad in (np.nan, np.inf, -np.inf):
        for place in (0, real[0].size // 2, real[0].size - 1):
            broken = real.copy()
            broken[2].flat[place] = bad
            found = extractor.extract(broken)
            assert np.isnan(found[2]).all()
            same(np.delete(found, 2, axis=0), np.delete(whole, 2, axis=0))


@extractor_check
def check_frames_without_contrast_are_nan_rows(cls, extractor, observations):
    if cls.about.observation is Observation.FRAMES:
        for dtype in (np.uint8, np.uint16, np.float32, np.float64):
            flat = np.full_like(observations, 255, dtype=dtype)
            assert np.isnan(extractor.extract(flat)).all()


@extractor_check
def check_refuses_wrong_input(cls, extractor, observations):
    assert_rejects(extractor.extract, wrong_arrays(observations))
    if cls.about.observation is Observation.CURRENTS:
        wrong = {"a column more": np.hstack([observations, observations[:, :1]])}
        assert_rejects(extractor.extract, wrong)


@extractor_check
def check_dtypes_agree(cls, extractor, observations):
    expected = extractor.extract(observations.astype(np.float64))
    for dtype in (bool, *"bBhHiIlLefd"):
        typed = observations.astype(dtype)
        if np.array_equal(typed, observations):
            np.testing.assert_allclose(extractor.extract(typed), expected, rtol=0, atol=1e-11)
    for dtype in (np.uint8, np.uint16, np.float32, np.float64):
        assert np.array_equal(observations.astype(dtype), observations)


@extractor_check
def check_memory_layouts_agree(cls, extractor, observations):
    wide = observations.astype(np.uint16)
    expected = extractor.extract(wide)
    readonly = wide.copy()
    readonly.flags.writeable = False
    padded = np.zeros((*wide.shape[:-1], wide.shape[-1] * 2), dtype=wide.dtype)
    padded[..., ::2] = wide
    unaligned = np.frombuffer(b"\0" + wide.tobytes(), dtype=wide.dtype, offset=1)
    for layout in (
        readonly,
        np.asfortranarray(wide),
        padded[..., ::2],
        wide[::-1][::-1],
        unaligned.reshape(wide.shape),
        wide.astype(wide.dtype.newbyteorder(">")),
    ):
        same(extractor.extract(layout), expected)
    same(extractor.extract(wide[::2]), expected[::2])
    same(extractor.extract(wide.tolist()), extractor.extract(wide.astype(np.int64)))


@extractor_check
def check_batch_of_one_equals_batch_of_many(cls, extractor, observations):
    for dtype in (np.uint16, np.float32, np.float64):
        typed = observations.astype(dtype)
        together = extractor.extract(typed)
        alone = np.vstack([extractor.extract(typed[i : i + 1]) for i in range(len(typed))])
        same(alone, together)
        same(extractor.extract(typed[::-1]), together[::-1])


@extractor_check
def check_is_deterministic(cls, extractor, observations):
    first = extractor.extract(observations)
    same(extractor.extract(observations), first)
    same(cls(**parameters(extractor)).extract(observations), first)


@extractor_check
def check_leaves_input_alone(cls, extractor, observations):
    for dtype in (np.uint16, np.float64):
        given = observations.astype(dtype)
        before = given.copy()
        extractor.extract(given)
        same(given, before)
        assert given.flags.writeable


@extractor_check
def check_survives_pickling(cls, extractor, observations):
    again = pickle.loads(pickle.dumps(extractor))
    assert again == extractor
    same(again.extract(observations), extractor.extract(observations))


@extractor_check
def check_names_the_geometry_it_needs(cls, extractor, observations):
    for name in cls.about.needs:
        with pytest.raises(UnsuitableDesignError, match=name):
            cls.for_sensor(SensorGeometry())
    if not cls.about.needs:
        assert isinstance(cls.for_sensor(SensorGeometry()), cls)


# Models


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


# The runs


@pytest.mark.parametrize("check", EXTRACTOR_CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("name", EXTRACTORS)
def test_extractor(name, check, design_for, observations_for):
    cls = EXTRACTORS[name]
    RAN.add((name, check.__name__))
    check(cls, cls.for_sensor(design_for(cls)), observations_for(cls))


@pytest.mark.parametrize("check", MODEL_CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("name", MODELS)
def test_model(name, check, design_for, calibration_for):
    cls = MODELS[name]
    RAN.add((name, check.__name__))
    design = design_for(cls)
    for kind in sorted(cls.about.accepts):
        extra = (design,) if "geometry" in check.__code__.co_varnames else ()
        check(cls, cls.for_sensor(design, kind), calibration_for(kind, design), *extra)


def test_every_check_ran_on_every_implementation(request):
    """An empty discovery, or a check that lost its decorator, must not look green."""
    source = [
        path.read_text(encoding="utf-8")
        for folder in ("extractors", "models")
        for path in (Path(algorithms.__file__).parent / folder).rglob("*.py")
    ]
    declared = sum(
        len(re.findall(r"^    about: ClassVar = About", text, re.MULTILINE)) for text in source
    )
    assert declared == len(EXTRACTORS) + len(MODELS) >= 14

    own = Path(__file__).read_text(encoding="utf-8")
    defined = len(re.findall(r"^def check_", own, re.MULTILINE))
    assert defined == len(EXTRACTOR_CHECKS) + len(MODEL_CHECKS)

    expected = {(name, check.__name__) for name in EXTRACTORS for check in EXTRACTOR_CHECKS}
    expected |= {(name, check.__name__) for name in MODELS for check in MODEL_CHECKS}
    collected = {
        (item.callspec.params["name"], item.callspec.params["check"].__name__)
        for item in request.session.items
        if item.path == Path(__file__) and hasattr(item, "callspec")
    }
    assert collected == expected
    if "PYTEST_XDIST_WORKER" not in os.environ:  # there each worker runs a share of them
        assert expected == RAN
