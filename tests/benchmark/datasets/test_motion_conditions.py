"""Conditions of a satellite that tumbles: whom they move, when, and who is left alone."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.conditions.motion import TUMBLING
from benchmark.seeds import generator
from benchmark.simulator.flight.spin import Spin

#: By the time between rows, seconds.
SETS = {
    "cmos-single-aperture": 512 * 80e-9,
    "ccd-single-aperture": 0.0,
}
NAMES = tuple(SETS)


@pytest.mark.parametrize("name", NAMES)
def test_only_the_test_split_turns_and_only_there(name: str) -> None:
    preset = datasets.get(name)
    for condition in preset.conditions:
        spinning = condition == "spinning"
        for split in ("calibration", "test", "repeat"):
            rate = preset.scene(condition, split).rate_deg_s
            assert (rate is not None) == (spinning and split != "calibration")
    assert "spinning" in preset.conditions
    one, other = (preset.scene(condition, "test") for condition in ("nominal", "spinning"))
    assert one.sun.tobytes() == other.sun.tobytes()
    assert one.irradiance.tobytes() == other.irradiance.tobytes()
    assert one.origin_px is not None
    assert np.array_equal(one.origin_px, other.origin_px)


@pytest.mark.parametrize("name", NAMES)
def test_passes_of_a_pose_turn_alike(name: str) -> None:
    preset = datasets.get(name)
    rate = preset.scene("spinning", "repeat").rate_deg_s
    assert rate is not None
    passes = rate.reshape(preset.repeats.passes, -1, 3)
    assert (passes == passes[0]).all()
    assert len(np.unique(passes[0], axis=0)) == passes.shape[1]


@pytest.mark.slow
def test_at_rest_light_is_that_of_the_nominal_condition() -> None:
    preset = datasets.get("cmos-single-aperture")
    means = []
    for condition in ("nominal", "spinning"):
        sensor = preset.sensor_for(condition, "calibration")
        scene = preset.scene(condition, "calibration").part(0, 8)
        means.append(sensor.expected(scene, preset.fixed_pattern(condition)))
    assert means[0].tobytes() == means[1].tobytes()


def test_axes_of_a_tumbling_body_are_uniform_over_the_sphere() -> None:
    count = 4000
    rates = Spin(30.0).draw(count, generator("test", "spin"))
    assert np.linalg.norm(rates, axis=1) == pytest.approx(30.0)
    axes = rates / 30.0
    # components are uniform in [-1, 1], of variance 1/3; their squares vary by 4/45
    assert np.abs(axes.mean(axis=0)).max() < 4 * math.sqrt(1 / 3 / count)
    assert np.square(axes).mean(axis=0) == pytest.approx(1 / 3, abs=4 * math.sqrt(4 / 45 / count))
    with pytest.raises(ValueError, match="rate_deg_s must be finite and positive"):
        Spin(0.0)


def test_a_sensor_that_is_not_exposed_over_time_is_refused_a_motion() -> None:
    nominal = datasets.get("cmos-single-aperture").setups["nominal"]
    with pytest.raises(ValueError, match="got DiffractiveFrameSensor"):
        replace(nominal, spin=TUMBLING)
