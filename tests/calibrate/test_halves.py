"""Fits to two halves: chance is no misfit, a wrong model is one, and unlike fields tell nothing."""

from __future__ import annotations

import bench
import numpy as np
import pytest
from samples import samples

from algorithms.contract import SensorGeometry
from algorithms.discovery import discover_models
from calibrate.calibration import calibrate
from calibrate.halves import Halves, _traces, halves
from calibrate.readings import Readings

NAMES = ["x_plus", "x_minus", "y_plus", "y_minus", "theta_x_deg", "theta_y_deg"]


def electrodes(path, seed):
    angles = bench.grid(21, 55.0)
    return bench.write(path, NAMES, bench.electrodes(bench.sun_of(angles), seed), angles)


@pytest.mark.parametrize("seed", [2, *(pytest.param(n, marks=pytest.mark.slow) for n in (0, 4))])
def test_a_model_that_fits_is_good_whatever_the_noise(seed, tmp_path):
    """On a grid of odd width every other pose has all four corners: halves were not alike."""
    made = electrodes(tmp_path / "bench.csv", seed)
    verdict = calibrate([made], models=("polynomial-2d",)).verdict
    assert verdict.word == "good"
    assert 0.7 < verdict.split_ratio < 2.0  # what is said to be a misfit


def test_a_model_that_does_not_follow_the_sensor_is_a_misfit(tmp_path):
    made = electrodes(tmp_path / "bench.csv", 0)
    verdict = calibrate([made], models=("qpd",)).verdict
    assert verdict.word == "model misfit"
    assert verdict.split_ratio > 2.0


@pytest.mark.parametrize("scales", [[1.0] * 12, [3.0, 1.0, 1.0, 0.1, 0.1, 0.1]])
def test_traces_of_few_refits_are_those_of_the_covariance(scales):
    variance = np.square(scales)
    drawn = np.random.default_rng(1)
    found = []
    for _ in range(2000):
        parts = drawn.normal(0.0, scales, (2, 3, len(scales))).reshape(2, 3, -1, 3)
        found.append(_traces(*(part - part.mean(axis=0) for part in parts)))
    expected = ((2 * variance.sum()) ** 2, 4 * (variance**2).sum())
    assert np.mean(found, axis=0) == pytest.approx(expected, rel=0.15)


CAMERA = SensorGeometry(focal_length_mm=3.5, pixel_pitch_mm=0.01, centre_px=(512.0, 512.0))
GRID = bench.grid(6, 8.0)


def camera(angles: np.ndarray, run: np.ndarray | None = None) -> Readings:
    sun = bench.sun_of(angles)
    return samples(bench.spots(sun, 1), sun, run=run)


def runs(*places: tuple[float, float]) -> Readings:
    """A run of 36 poses around each place."""
    angles = np.vstack([GRID + np.asarray(place) for place in places])
    return camera(angles, np.repeat(np.arange(len(places)), 36))


def compared(used: Readings, noise: float = 0.01) -> Halves:
    return halves(discover_models()["homography"], used, CAMERA, np.full(len(used), noise))


def test_three_runs_of_one_field_are_halved_by_runs_and_compared() -> None:
    found = compared(runs((0.0, 0.0), (0.3, 0.3), (-0.3, -0.3)))
    assert 0.2 < found.ratio < 2.0
    assert found.chance > 1e-3
