"""How far the sunlit Earth moves what sensors behind openings say: numbers known from elsewhere."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.geometric.standard_projection import StandardProjection
from algorithms.pipeline import Pipeline
from benchmark import datasets
from benchmark.metrics.separation import separation_deg


def moved_deg(name: str, condition: str, samples: int) -> np.ndarray:
    """Angle between the balance's answers with and without the Earth; no noise."""
    preset: Any = datasets.get(name)
    sensor = preset.condition(condition).sensor
    pattern = preset.fixed_pattern(condition)
    pipeline = Pipeline.for_sensor(VoltageBalance, StandardProjection, preset.geometry)
    ground = preset.scene(condition, "calibration")
    pipeline.fit(sensor.expected(ground, pattern), ground.sun)
    scene = preset.scene(condition, "test").part(0, samples)
    answers = [
        pipeline.predict(sensor.expected(seen, pattern))
        for seen in (scene, replace(scene, albedo=None))
    ]
    return np.asarray(separation_deg(*answers))


@pytest.mark.parametrize("condition", ["albedo", "albedo-clouds"])
def test_the_quadrant_sensors_balance_moves_as_estimated(condition: str) -> None:
    """Estimated apart at 600 km and random attitude: 0.69 deg RMS, 1.7 deg at 95 %.

    Over 1,000 attitudes the root mean square has a standard error of 0.03 deg.
    """
    moved = moved_deg("qpd-single-aperture", condition, 1000)
    assert math.sqrt(np.mean(moved**2)) == pytest.approx(0.69, rel=0.3)
    assert np.quantile(moved, 0.95) == pytest.approx(1.7, rel=0.3)
    # a good half of the attitudes have no lit Earth in the field at all
    assert 0.2 < np.mean(moved < 0.01) < 0.6


def test_the_effect_follows_from_how_much_light_falls_where() -> None:
    """Closed form: a balance of sunlight mixed with the Earth's, shares ``a`` and ``1 - a``.

    ``S' = ((1 - a) S + a E)``; a small share moves the tangent by ``a (E - S)`` of its scale.
    """
    preset: Any = datasets.get("qpd-single-aperture")
    sensor = preset.condition("albedo").sensor
    scene = preset.scene("albedo", "test").part(0, 300)
    pattern = {"gain": np.ones(4)}
    clear = replace(
        sensor, readout=replace(sensor.readout, dark=replace(sensor.readout.dark, at_25_c=0.0))
    )
    currents = clear.expected(replace(scene, albedo=None), pattern)
    earth = clear.readout.sunlit_ua * scene.albedo
    mixed = VoltageBalance().extract(clear.expected(scene, pattern))
    seen = earth.sum(axis=1) > 0
    share = (earth.sum(axis=1) / (earth + currents).sum(axis=1))[seen, None]
    balance, of_earth = (VoltageBalance().extract(one[seen]) for one in (currents, earth))
    expected = (1.0 - share) * balance + share * of_earth
    assert mixed[seen] == pytest.approx(expected, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("pd-single-aperture", 1.0, 2.0),
        ("pd-slit", 1.3, 2.5),
        ("psd-single-aperture", 0.5, 2.0),
    ],
)
def test_wider_fields_see_more_of_the_earth(name: str, low: float, high: float) -> None:
    """As flown: 2.5 deg at 95 % (ESTCube-1), about 5 in orbit for position-sensitive devices."""
    moved = moved_deg(name, "albedo", 500)
    assert low < math.sqrt(np.mean(moved**2)) < high
    assert 1.5 < np.quantile(moved, 0.95) < 6.0
