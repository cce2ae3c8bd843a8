"""Errors that intervals are made from, and what is said where samples are too few."""

from __future__ import annotations

import bench
import numpy as np
import pytest
from samples import samples

from algorithms.angles import separation_deg
from algorithms.contract import SensorGeometry, UnusableDataError
from algorithms.discovery import discover_models
from calibrate.selection import compare, fitted
from calibrate.uncertainty import (
    errors_left_out,
    intervals,
    noise_deg,
    refits,
)

SUN = bench.sun_of(np.random.default_rng(1).uniform(-40.0, 40.0, (400, 2)))
CAMERA = SensorGeometry(focal_length_mm=3.5, pixel_pitch_mm=0.01, centre_px=(512.0, 512.0))
#: Normal offsets, degrees an axis.
NOISE = 0.2


def offsets(count: int, noise: float = NOISE) -> np.ndarray:
    drawn = np.random.default_rng(2).normal(0.0, np.radians(noise), (count, 3))
    along = (drawn * SUN[:count]).sum(axis=1)[:, None] * SUN[:count]
    return np.asarray(drawn - along)


def test_the_sigma_is_that_of_the_errors() -> None:
    found = intervals(offsets(400), SUN)
    assert found is not None
    assert found.at(SUN) == pytest.approx(np.full((400, 2), NOISE), rel=0.15)
    assert found.factor == pytest.approx(1.0, rel=0.05)
    assert found.coverage == pytest.approx(0.95, abs=0.02)
    assert found.samples == 400


@pytest.mark.parametrize(("count", "known"), [(39, False), (40, True)])
def test_forty_samples_are_enough_for_intervals(count: int, known: bool) -> None:
    assert (intervals(offsets(count), SUN[:count]) is not None) is known


def test_noise_is_not_known_of_fewer_than_ten_samples() -> None:
    off = offsets(20)
    assert np.isfinite(noise_deg(off[:10], SUN[:10]))
    off[9:] = np.nan
    assert np.isnan(noise_deg(off, SUN[:20]))


def test_refits_that_all_fail_say_what_the_model_said() -> None:
    line = np.column_stack([np.linspace(400.0, 600.0, 30), np.full(30, 512.0)])
    used = samples(line, bench.sun_of(np.column_stack([np.linspace(-20, 20, 30), np.zeros(30)])))
    noise = np.full(30, 0.01)
    with pytest.raises(UnusableDataError, match="homography"):
        refits(discover_models()["homography"], used, CAMERA, noise, used, count=2)
    with pytest.raises(UnusableDataError, match="no refit settles the model"):
        refits(discover_models()["homography"], used, CAMERA, noise, used, count=0)


GRID = bench.sun_of(bench.grid(13, 40.0))
HOMOGRAPHY = discover_models()["homography"]


def left_out(wrong_deg: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Errors and directions of a grid of spots whose row 6 was removed, that being wrong."""
    used = samples(bench.spots(GRID, 1), GRID)
    kept, gone = np.arange(len(GRID)) != 6, np.arange(len(GRID)) == 6
    turned = samples(used.features[gone], GRID[gone] @ bench.turn("x", wrong_deg).T)
    used = used.only(kept)
    (chosen,) = compare(used, CAMERA, {"homography": HOMOGRAPHY})
    model = fitted(HOMOGRAPHY, used, CAMERA)
    return errors_left_out(HOMOGRAPHY, chosen, used, CAMERA, model, turned)


def test_the_rim_of_the_field_is_left_out_too() -> None:
    used = samples(bench.spots(GRID, 1), GRID)
    (chosen,) = compare(used, CAMERA, {"homography": HOMOGRAPHY})
    rim = np.isnan(np.asarray(chosen.offsets)).all(axis=1)
    assert rim.sum() >= 20
    assert rim[0]  # a corner
    model = fitted(HOMOGRAPHY, used, CAMERA)
    offsets, sun = errors_left_out(HOMOGRAPHY, chosen, used, CAMERA, model, used.only(rim & False))
    assert np.isfinite(offsets).all(axis=1).mean() > 0.95
    # 0.05 px an axis at 350 px of focal length, foreshortened away from the middle
    size = separation_deg(offsets + sun, sun)[rim]
    assert 0.003 < np.sqrt(np.nanmean(size**2)) < 0.0116


def test_a_sample_that_the_model_removed_counts_with_its_error() -> None:
    offsets, sun = left_out(wrong_deg=2.0)
    assert len(offsets) == len(sun) == len(GRID)
    assert np.degrees(np.linalg.norm(offsets[-1])) > 1.0
