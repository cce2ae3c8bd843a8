"""Runs whose directions are off by a constant, among others that agree."""

from __future__ import annotations

import bench
import numpy as np
import pytest
from samples import samples

from calibrate.exclusions import off_runs
from calibrate.readings import Readings


def runs(counts: list[int], off: dict[int, float]) -> Readings:
    """Runs of random poses of one camera, some turned about x by so many degrees."""
    rng = np.random.default_rng(8)
    run = np.repeat(np.arange(len(counts)), counts)
    sun = bench.sun_of(rng.uniform(-30.0, 30.0, (len(run), 2)))
    told = sun.copy()
    for number, angle in off.items():
        told[run == number] = sun[run == number] @ bench.turn("x", angle).T
    return samples(bench.spots(sun, 3), told, run=run)


def found(counts: list[int], off: dict[int, float]) -> list[int]:
    return [one.run for one in off_runs(runs(counts, off))]


def test_a_run_is_off_by_the_angle_that_it_was_turned() -> None:
    (one,) = off_runs(runs([120] * 5, {3: 0.5}))
    assert one.run == 3
    assert one.offset_deg == pytest.approx(0.5, abs=0.02)
    assert one.others_deg < 0.02


def test_the_farthest_run_comes_first_and_agreeing_runs_are_none() -> None:
    assert found([120] * 6, {1: 0.3, 4: -0.8}) == [4, 1]
    assert found([120] * 5, {}) == []


def test_runs_below_twenty_readings_are_not_judged_and_judge_none() -> None:
    assert found([120, 120, 120, 120, 19], {4: 5.0}) == []
    assert found([120, 120, 120, 120, 20], {4: 5.0}) == [4]
    assert found([120, 120, 19, 19, 19], {1: 2.0}) == []  # two runs do not say which is off


def test_half_of_the_runs_or_more_cannot_be_off() -> None:
    assert found([120] * 5, {0: 0.5, 1: -0.6, 2: 0.9}) == []
