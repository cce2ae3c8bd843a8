"""Halves of the samples are not compared where they share no field, or settle no fit."""

from __future__ import annotations

import bench
import numpy as np
import pytest
from samples import samples

from algorithms.contract import SensorGeometry
from algorithms.discovery import discover_models
from calibrate.halves import Halves, halves
from calibrate.readings import Readings

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


@pytest.mark.parametrize(
    ("used", "noise"),
    [
        pytest.param(camera(GRID), 0.0, id="readings without noise"),
        pytest.param(camera(GRID), np.nan, id="noise not known"),
        pytest.param(camera(GRID[:6]), 0.01, id="poses of a half along a line"),
        pytest.param(
            runs((30.0, 0.0), (-20.0, 25.0), (-20.0, -25.0)), 0.01, id="runs of fields apart"
        ),
    ],
)
def test_what_is_not_known_is_said_to_be_no_misfit(used: Readings, noise: float) -> None:
    found = compared(used, noise)
    assert np.isnan(found.ratio)
    assert found.chance == 1.0
