"""`measure` on everything discovered: agrees with `extract`, takes one sample, takes a mask."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.contract import Observation
from algorithms.discovery import discover_extractors
from algorithms.extractors.frames.centroid import BasicCentroid
from algorithms.measurement import QualityFlag, without_bad

EXTRACTORS = discover_extractors()


@pytest.fixture(params=EXTRACTORS)
def case(request, design_for, observations_for):
    cls = EXTRACTORS[request.param]
    return cls.for_sensor(design_for(cls)), observations_for(cls)


def test_features_are_those_of_extract_and_flags_say_what_is_missing(case):
    extractor, observations = case
    observations = observations.copy()
    observations[1] = 0
    found = extractor.measure(observations)
    expected = extractor.extract(observations)
    np.testing.assert_array_equal(found.features, expected, strict=True)
    n, f = expected.shape
    assert found.covariance.shape == (n, f, f)
    assert found.covariance.dtype == np.float64
    assert found.flags.shape == (n,)
    missing = np.isnan(expected).any(axis=1)
    assert missing[1]
    assert (found.flags[missing] != 0).all()
    assert np.isnan(found.covariance[missing]).all()
    stated = ~np.isnan(found.covariance).any(axis=(1, 2))
    assert (np.linalg.eigvalsh(found.covariance[stated]) > 0).all()


def test_a_single_sample_is_a_batch_of_one(case):
    extractor, observations = case
    one, batch = extractor.measure(observations[0]), extractor.measure(observations[:1])
    np.testing.assert_array_equal(one.features, batch.features)
    np.testing.assert_array_equal(one.covariance, batch.covariance)
    np.testing.assert_array_equal(one.flags, batch.flags)


def test_bad_pixels_do_not_count_or_the_mask_is_refused(case):
    extractor, observations = case
    shape = observations.shape[1:]
    bad = np.zeros(shape, dtype=np.bool_)
    bad.flat[3] = True
    if extractor.about.observation not in {Observation.FRAMES, Observation.PROFILES}:
        with pytest.raises(ValueError, match="got a mask"):
            extractor.measure(observations, bad)
        return
    hot = observations.copy()
    hot.reshape(len(hot), -1)[:, 3] = 255
    np.testing.assert_array_equal(
        extractor.measure(hot, bad).features, extractor.measure(observations, bad).features
    )
    none = np.zeros(shape, dtype=np.bool_)
    np.testing.assert_array_equal(
        extractor.measure(observations, none).features, extractor.extract(observations)
    )
    for wrong, said in (
        (bad[1:], "shape"),
        (bad[None], "shape"),
        (bad.astype(np.uint8), "boolean"),
        (np.ones(shape, dtype=np.bool_), "leave"),
    ):
        with pytest.raises(ValueError, match=said):
            extractor.measure(observations, wrong)


def test_a_bad_pixel_becomes_the_median_of_its_good_neighbours():
    frame = np.arange(25.0).reshape(5, 5)
    bad = np.zeros((5, 5), dtype=np.bool_)
    bad[2, 2] = bad[2, 3] = bad[0, 0] = True
    broken = np.where(bad, np.nan, frame)[None]
    found = without_bad(broken, bad, "any")[0]
    assert found[2, 2] == np.median([6, 7, 8, 11, 16, 17, 18])
    assert found[0, 0] == np.median([1, 5, 6])
    np.testing.assert_array_equal(found[~bad], frame[~bad])
    assert np.isnan(broken[0][bad]).all()


@pytest.mark.parametrize("masked", [False, True])
def test_missing_pixels_are_bad_pixels(case, masked):
    extractor, observations = case
    if extractor.about.observation not in {Observation.FRAMES, Observation.PROFILES}:
        return
    whole = observations.astype(np.float64)
    bad = np.zeros(whole.shape[1:], dtype=np.bool_)
    bad.flat[3] = True
    broken = np.where(bad, np.nan, whole)
    if masked:
        broken = np.ma.masked_array(whole, np.broadcast_to(bad, whole.shape))
    found = extractor.measure(broken)
    expected = extractor.measure(without_bad(whole, bad, "any"))
    np.testing.assert_array_equal(found.features, expected.features)
    np.testing.assert_array_equal(found.flags, expected.flags)


def test_a_frame_without_a_pixel_has_no_spot():
    frame = np.zeros((5, 5))
    frame[2, 3], frame[0, 0] = 7.0, np.nan
    np.testing.assert_array_equal(BasicCentroid().measure(frame).features, [[3.0, 2.0]])
    np.testing.assert_array_equal(
        BasicCentroid().measure(frame, np.isnan(frame)).features, [[3.0, 2.0]]
    )
    found = BasicCentroid().measure(np.full((5, 5), np.nan))
    assert QualityFlag(found.flags[0]) == QualityFlag.NO_SPOT


def test_rows_of_different_lengths_are_refused_as_by_extract() -> None:
    ragged = [[[1.0, 2.0], [3.0]], [[1.0, 2.0], [3.0, 4.0]]]
    for read in (BasicCentroid().extract, BasicCentroid().measure):
        with pytest.raises(ValueError, match=r"\(N, H, W\)"):
            read(ragged)
