"""Masks whose apertures are off: what is learned of them against what they are off by."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.angles import separation_deg
from algorithms.calibration.coded.built_places import Sightings, hole_offsets
from algorithms.contract import UnusableDataError
from algorithms.examples import sun_grid
from algorithms.models.geometric.spot_array import SpotArray

GRID = tuple((40.3 * i, 40.3 * j, 8.0) for j in range(-3, 4) for i in range(-3, 4))
FOCAL_PX = 150.0


def array():
    return SpotArray(GRID, 1.5, 0.01, (250.0, 260.0))


def built(seed=1, off=0.1):
    return np.array(GRID)[:, :2] + np.random.default_rng(seed).normal(0.0, off, (len(GRID), 2))


def spots(sun, places, noise=0.0, bias=0.0, seen=1.0):
    """Lists of a mask with apertures at `places`, some of them dark, under a pixel grid's bias."""
    rng = np.random.default_rng(2)
    at = places + (250.0, 260.0) + FOCAL_PX * (sun[:, :2] / sun[:, 2:])[:, None]
    at = at + bias * np.sin(2.0 * np.pi * at) + rng.normal(0.0, noise or 1e-300, at.shape)
    lit = rng.random(at.shape[:2]) < seen
    return np.dstack([np.where(lit[:, :, None], at, 0.0), lit]).reshape(len(sun), -1)


def error_deg(model, lists, sun):
    return float(np.sqrt(np.mean(separation_deg(model.predict(lists), sun) ** 2)))


def test_offsets_are_those_of_the_mixed_models_equations():
    rng = np.random.default_rng(6)
    frames, holes = np.nonzero(rng.random((30, 12)) < 0.5)
    truth, moved = rng.normal(0.0, 0.1, (12, 2)), rng.normal(0.0, 0.05, (30, 2))
    away = truth[holes] + moved[frames] + rng.normal(0.0, 0.01, (len(holes), 2))
    weights = rng.uniform(0.5, 1.0, 30)
    seen = Sightings(away, frames, holes)
    offsets, doubts, (spot, hole, frame) = hole_offsets(away, seen, weights, (1e-4, 1e-2, 2.5e-3))
    # the same by the samples' whole covariance: cov(o, y) cov(y, y)^-1 y, with the same variances
    offsets, doubts, _ = hole_offsets(away, seen, weights, (spot, hole, frame))
    same_hole = holes[:, None] == holes
    covariance = hole * same_hole + frame * (frames[:, None] == frames)
    covariance = covariance + np.diag(spot / weights[frames])
    with_offsets = hole * (np.arange(12)[:, None] == holes)
    expected = with_offsets @ np.linalg.solve(covariance, away)
    np.testing.assert_allclose(offsets, expected, atol=2e-3)
    assert np.sqrt([spot, hole, frame]) == pytest.approx([0.01, 0.1, 0.05], rel=0.5)
    assert 0.3 < np.sqrt(np.mean((offsets - truth) ** 2) / doubts.mean()) < 2.0


def test_array_answers_the_same_whichever_apertures_are_seen():
    sun, places = sun_grid(range(-40, 41, 10)), built()
    model = array().fit(spots(sun, places), sun)
    between = sun_grid(range(-35, 36, 10))
    assert error_deg(model, spots(between, places, seen=0.5), between) < 1e-4


def test_array_is_freed_of_the_bias_of_the_pixels_grid():
    sun, places = sun_grid(range(-40, 41, 10)), built()
    model = array().fit(spots(sun, places, bias=0.01), sun)
    between = sun_grid(range(-35, 36, 10))
    lists = spots(between, places, bias=0.01)
    model_px = error_deg(model, lists, between) / np.degrees(1.0 / FOCAL_PX)
    assert model_px < 2e-4  # of 0.01


def test_array_without_spots_has_no_direction():
    sun = sun_grid(range(-40, 41, 10))
    model = array().fit(spots(sun, built()), sun)
    dark = np.zeros((1, 3 * len(GRID)))
    assert np.isnan(model.predict(dark)).all()
    with pytest.raises(UnusableDataError):
        array().fit(np.zeros((len(sun), 3 * len(GRID))), sun)
