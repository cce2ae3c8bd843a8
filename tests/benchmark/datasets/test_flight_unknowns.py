"""What is unknown of a unit in flight: against inverted matrices and sensors that were moved."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.conditions import flight_unknowns
from benchmark.datasets.conditions.flight_unknowns import unit_angle_deg, unknowns
from benchmark.metrics.posterior_bound import Motion, recursive_bound
from benchmark.simulator.flight.gyro import Gyro

RATES = ["offset_x_mm_k", "tilt_y_deg_year", "focal_length_mm_year"]


def test_a_body_at_rest_knows_what_all_its_readings_together_tell() -> None:
    """Attitude and two constants, every reading of other slopes, inverted at once."""
    rng, count = np.random.default_rng(3), 12
    slopes = rng.standard_normal((count, 4, 5)) * [1e3, 1e3, 1e3, 1.0, 1.0]
    information = np.swapaxes(slopes, 1, 2) @ slopes
    known = np.array([[3.0, 0.5], [0.5, 2.0]])
    motion = Motion(np.tile(np.eye(3), (count, 1, 1)), np.arange(count) * 10.0, Gyro(0, 0, 0))
    sun = np.tile([0.0, 0.0, 1.0], (count, 1))
    found = recursive_bound(sun, information, motion, known)
    whole = np.zeros((5, 5))
    whole[3:, 3:] = known
    for n in range(count):
        whole += information[n]
        covariance = np.linalg.inv(whole)
        expected = math.degrees(math.sqrt(covariance[0, 0] + covariance[1, 1]))
        assert found[n] == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("rate", RATES)
def test_a_head_that_moves_shows_the_sun_elsewhere(rate: str) -> None:
    """Readings of quadrants whose head drifts a little more, against those of a Sun turned."""
    preset: Any = datasets.get("qpd-orbit")
    scene = preset.scene("nominal", "test", 400).part(250, 400)
    ((sensor, _, pattern),) = preset.taken("nominal", "test", scene)
    head = sensor.assembly
    # unknowns are Fisher matrices of the readings' slopes: those are told by one reading at a time
    column = 4 + 4 * 3 + 5 + [name for name, _ in flight_unknowns._rates(head)].index(rate)
    told = flight_unknowns._reading_slopes(preset, "nominal", sensor, scene, pattern)[0]
    told = told[:, :, column]
    step = 1e-2
    ends = [
        replace(
            sensor, assembly=replace(head, **{rate: getattr(head, rate) * (1.0 + sign * step)})
        ).expected(scene, pattern)
        for sign in (1, -1)
    ]
    moved = (ends[0] - ends[1]) / (2.0 * step)
    assert np.abs(moved).max() > 0
    np.testing.assert_allclose(told, moved, atol=0.02 * np.abs(moved).max())


def test_of_one_sample_gains_are_as_unknown_as_calibration_poses_leave_them() -> None:
    """The same number by unknowns in a matrix and by a variance that adds to the readings'."""
    preset: Any = datasets.get("pd-orbit")
    single = preset.sample_bound("nominal", "test")
    own = unknowns(preset, "nominal")
    assert own is not None
    assert single.unit_angle_deg is not None
    found = unit_angle_deg(own, replace(single, unit_angle_deg=None))
    seen = single.observable
    # poses tell a little less where their stray light is not known
    np.testing.assert_allclose(found[seen], single.unit_angle_deg[seen], rtol=2e-3)
    assert np.isinf(found[~seen]).all()


def test_nothing_is_unknown_of_pixels_behind_a_head_that_stands_still() -> None:
    preset: Any = datasets.get("ccd-orbit")
    assert unknowns(preset, "stable") is None
