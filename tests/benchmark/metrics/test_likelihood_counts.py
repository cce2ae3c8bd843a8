"""Whole counts of light-to-frequency converters are estimated as well as both bounds say.

A count says where between two whole numbers its mean is by chance alone: the bound depends on the
irradiance of the moment, so that it is compared over irradiances. Counts are efficient for their
means (their variance is what `counts_variance` states), and the means nearly linear over a count:
weighted least squares are what the most likely direction comes to.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from benchmark import datasets
from benchmark.metrics.bounds import cramer_rao, unit_variance
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import from_angles, tangent_axes
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene

OFFERED = References()
TRIALS = 600
SETUP = datasets.get("ltf-maskless-cube").setups["nominal"]


def scene_of() -> Scene:
    sun = np.repeat(from_angles(np.array([25.0]), np.array([40.0])), TRIALS, axis=0)
    light, stray = SETUP.irradiance.draw(TRIALS, generator("test", "counts", "light"))
    return Scene(sun, light, stray)


def least_squares_deg(
    hertz: np.ndarray, scene: Scene, pattern: dict[str, Any], variance: np.ndarray
) -> np.ndarray:
    """(N, 2) errors along two tangent axes; weights are those of the true means."""
    spread = SETUP.irradiance
    first, second = tangent_axes(scene.sun)
    typical = np.array([0.0, 0.0, 1.0, spread.stray])
    prior = np.diag([0.0, 0.0, spread.spread**-2, spread.stray_spread**-2])

    def mean(p: np.ndarray) -> np.ndarray:
        sun = scene.sun + p[:, :1] * first + p[:, 1:2] * second
        sun /= np.linalg.norm(sun, axis=1, keepdims=True)
        return np.asarray(SETUP.sensor.expected(Scene(sun, p[:, 2], p[:, 3]), pattern))

    guess = np.repeat([typical], len(hertz), axis=0)
    for _ in range(4):
        steps = np.diag([1e-4, 1e-4, 1e-3, 1e-4])
        slopes = [(mean(guess + s) - mean(guess - s)) / (2 * s.max()) for s in steps]
        slope = np.stack(slopes, axis=2)
        left = np.einsum("nmi,nm,nmj->nij", slope, 1 / variance, slope) + prior
        right = np.einsum("nmi,nm,nm->ni", slope, 1 / variance, hertz - mean(guess))
        right -= (guess - typical) @ prior
        guess = guess + np.linalg.solve(left, right[:, :, None])[:, :, 0]
    return np.degrees(guess[:, :2])


def test_known_converters_are_at_the_bound() -> None:
    scene = scene_of()
    pattern = dict(SETUP.sensor.fixed_pattern("test", "counts", 0))
    bound = cramer_rao(SETUP.sensor, scene, pattern, SETUP.irradiance)
    hertz = SETUP.sensor.observe(scene, pattern, NoiseStreams.named("test", "counts"))
    variance = SETUP.sensor.variance(SETUP.sensor.expected(scene, pattern))
    errors = least_squares_deg(hertz, scene, pattern, variance)
    found = math.sqrt(2 * np.mean(errors**2))
    assert found == pytest.approx(math.sqrt(np.mean(bound.angle_deg**2)), rel=0.1)


@pytest.mark.slow
def test_converters_known_by_flats_are_at_the_second_bound() -> None:
    """Another unit in every trial, of normals that are known."""
    sensor: Any = SETUP.sensor
    scene = scene_of()
    built = sensor.fixed_pattern("test", "counts", 0)
    streams = NoiseStreams.named("test", "counts", "units")
    information = OFFERED.flats * sensor.readout.gate_s**2 / (1 / 6)
    light = OFFERED.level * sensor.readout.sunlit_hz
    weight = light**2 * information
    squares, bounds = [], []
    for n in range(TRIALS):
        one = scene.part(n, n + 1)
        unit = {**built, "gain": sensor.fixed_pattern("test", "counts", n)["gain"]}
        bound = cramer_rao(sensor, one, unit, SETUP.irradiance, references=OFFERED)
        assert bound.unit_angle_deg is not None
        bounds.append(bound.unit_angle_deg[0] ** 2)
        readings = sensor.reference_readings(unit, OFFERED, streams)
        # the rate a flat makes is not quite proportional to the gain: the slope there is
        level = np.full(len(unit["gain"]), OFFERED.level)
        typical = sensor.readout.rate(level, np.ones(len(level)))
        slope = sensor.readout.rate(level, 1 + 1e-4 * np.ones(len(level))) - typical
        seen = (readings["flat_hz"] - typical) / (slope / 1e-4)
        gain = 1 + seen * weight / (weight + sensor.readout.gain_mismatch**-2)
        hertz = sensor.observe(one, unit, streams)
        expected = sensor.expected(one, unit)
        left = unit_variance(sensor, expected, one, OFFERED)
        assert left is not None
        variance = sensor.variance(expected) + left
        squares.append(
            2 * np.mean(least_squares_deg(hertz, one, {**built, "gain": gain}, variance) ** 2)
        )
    assert math.sqrt(np.mean(squares)) == pytest.approx(math.sqrt(np.mean(bounds)), rel=0.15)
