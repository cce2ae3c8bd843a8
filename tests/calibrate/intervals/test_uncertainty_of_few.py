"""What is said of a calibration's uncertainty where samples are too few, or settle no fit."""

from __future__ import annotations

import bench
import numpy as np
import pytest
from samples import samples

from algorithms.contract import SensorGeometry, UnusableDataError
from algorithms.discovery import discover_models
from calibrate.uncertainty import (
    intervals,
    noise_deg,
    refits,
)

SUN = bench.sun_of(np.random.default_rng(1).uniform(-40.0, 40.0, (400, 2)))
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
    camera = SensorGeometry(focal_length_mm=3.5, pixel_pitch_mm=0.01, centre_px=(512.0, 512.0))
    noise = np.full(30, 0.01)
    with pytest.raises(UnusableDataError, match="homography"):
        refits(discover_models()["homography"], used, camera, noise, used, count=2)
    with pytest.raises(UnusableDataError, match="no refit settles the model"):
        refits(discover_models()["homography"], used, camera, noise, used, count=0)
