"""Linear CCDs: charge is conserved and spills along its own array."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.blooming_lines import BloomingLineSensor
from benchmark.simulator.sensors.line_sensor import LineSensor

PRESET = datasets.get("ccd-slit")
FULL, GAIN, OFFSET = 100_000.0, 25.0, 16.0


def saturated() -> BloomingLineSensor:
    sensor = PRESET.setups["saturated"].sensor
    assert isinstance(sensor, BloomingLineSensor)
    return sensor


def scene_over(*angles: tuple[float, float]) -> Scene:
    alpha, beta = np.array(angles, dtype=float).T
    return Scene(from_angles(alpha, beta), np.ones(len(alpha)), np.full(len(alpha), 0.002))


def test_charge_is_conserved_and_stays_in_its_array() -> None:
    rng = np.random.default_rng(3)
    sensor = saturated()
    for full in (0.0, 40.0):
        charge = rng.uniform(0, FULL, (5, 2048))
        charge[:, 900:940] += full * FULL
        held, drained = sensor.held(charge)
        before, after = charge.reshape(5, 2, 1024).sum(axis=2), held.reshape(5, 2, 1024).sum(axis=2)
        assert after + drained == pytest.approx(before, rel=1e-12)
        assert held.max() <= FULL * (1 + 1e-12)
        assert np.array_equal(held[:, 1024:], charge[:, 1024:])
        assert (drained[:, 0] > 0).all() == (full > 0)
        assert not drained[:, 1].any()


def test_half_of_the_overflow_widens_the_spot_on_either_side() -> None:
    """Twelve pixels of 2.4 wells each: 1.4 wells a pixel flow out, half to the left."""
    charge = np.zeros((1, 2048))
    charge[0, 500:512] = 2.4 * FULL
    held, _ = saturated().held(charge)
    full = np.flatnonzero(np.isclose(held[0], FULL))
    assert (full[0], full[-1]) == (492, 519)
    assert held[0, [491, 520]] == pytest.approx(0.4 * FULL)
    assert held[0].sum() == pytest.approx(charge.sum())


def test_the_saturated_profile_has_the_charge_of_its_light() -> None:
    sensor, pattern = saturated(), PRESET.fixed_pattern("saturated")
    straight = replace(sensor.detector.errors, nonlinearity=0.0)
    sensor = replace(sensor, detector=replace(sensor.detector, errors=straight))
    scene = scene_over((0, 0), (31, -42), (-40, 45))
    light = LineSensor._electrons(sensor, scene, pattern)
    picture = (sensor.picture(scene, pattern) - OFFSET) * GAIN
    assert picture.sum(axis=1) == pytest.approx(light.sum(axis=1), rel=1e-12)
    # wider than the same light without spilling
    cut = np.minimum(light, FULL)
    assert ((picture > 0.99 * FULL).sum(axis=1) > (cut > 0.99 * FULL).sum(axis=1) + 8).all()


def test_statistics_of_the_bound_have_the_variance_they_state() -> None:
    sensor, pattern = saturated(), PRESET.fixed_pattern("saturated")
    scene = scene_over((14.0, -33.0))
    mean = sensor._electrons(scene, pattern)[0]
    expected = sensor.expected(scene, pattern)
    assert expected.shape == (1, 2050)
    draws = np.random.default_rng(2).poisson(mean, (2000, 2048)).reshape(2000, 2, 1024)
    over = np.maximum(draws - FULL, 0).sum(axis=2)
    single = 20.0**2 + GAIN**2 / 12
    stated = sensor.variance(expected)[0, -2:] - 2 * single
    assert over.mean(axis=0) == pytest.approx(expected[0, -2:], rel=1e-3)
    assert over.var(axis=0, ddof=1) == pytest.approx(stated, rel=0.15)


def test_saturation_costs_accuracy_but_little_is_lost() -> None:
    """Eight times the light, tops cut flat: edges and the overflow still tell."""
    nominal, bright = (PRESET.bound(c, n=20).rms_deg for c in ("nominal", "saturated"))
    assert 0.3 * nominal < bright < 2 * nominal
