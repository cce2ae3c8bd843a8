"""What every extractor must do, check by check."""

from __future__ import annotations

import dataclasses
import json
import pickle
from collections.abc import Callable

import numpy as np
import pytest
from expectations import assert_documented, assert_metadata, assert_rejects, same, wrong_arrays

from algorithms.contract import (
    Extractor,
    FeatureKind,
    Observation,
    SensorGeometry,
    UnsuitableDesignError,
    parameters,
)

EXTRACTOR_CHECKS: list[Callable[..., None]] = []


def extractor_check(function):
    EXTRACTOR_CHECKS.append(function)
    return function


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
