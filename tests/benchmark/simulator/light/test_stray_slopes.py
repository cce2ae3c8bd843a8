"""Stray light that slopes across a few large elements, and along arrays of many."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bare_pixels import bare

from benchmark import datasets
from benchmark.simulator.light.stray_slope import UnevenScene
from benchmark.simulator.scene import Scene

SLOPE = (0.003, -0.002)


def scenes() -> tuple[Scene, UnevenScene]:
    sun = np.array([[0.0, 0.0, 1.0], [0.3, -0.1, math.sqrt(0.9)]])
    even = Scene(sun, np.ones(2), np.array([0.01, 0.02]))
    return even, UnevenScene.of(even, np.tile(SLOPE, (2, 1)))


def change(sensor: Any) -> np.ndarray:
    even, uneven = scenes()
    difference = sensor.receive(uneven) - sensor.receive(even)
    assert difference[0] == pytest.approx(difference[1])  # wherever the Sun is
    return np.asarray(difference[0])


def test_a_quadrant_gets_what_falls_on_its_middle() -> None:
    """Light ``slope . (x, y)`` averaged over a square from the gap to the edge."""
    sensor: Any = datasets.get("qpd-single-aperture").setups["nominal"].sensor
    off = (0.025 + 1.8) / 2.0 / 1.8
    signs = np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)])
    assert change(sensor) == pytest.approx(off * signs @ np.array(SLOPE), rel=1e-12)


def test_a_position_sensitive_device_divides_sloping_light_by_its_own_shares() -> None:
    """Counted over the whole of a linear device, point by point."""
    sensor: Any = datasets.get("psd-single-aperture").setups["linear"].sensor
    half = sensor.detector.length_mm / 2.0
    place = (np.arange(200) - 99.5) / 100.0
    x, y = np.meshgrid(place, place)
    light = SLOPE[0] * x + SLOPE[1] * y
    shares = sensor.detector.shares(x * half, y * half)
    # midpoints: second moments are short by 1 / 200^2
    assert change(sensor) == pytest.approx((light[..., None] * shares).mean(axis=(0, 1)), rel=1e-4)


def test_diodes_of_a_slit_pair_lie_on_the_diagonals() -> None:
    sensor: Any = datasets.get("pd-slit").setups["nominal"].sensor
    q1, q2, q3, q4 = change(sensor)
    assert [q1, q2] == pytest.approx([-q3, -q4])
    off = (0.025 + 2.9) / 2.0 / 2.9 / math.sqrt(2.0)
    assert [q2, q1] == pytest.approx([off * (0.003 - 0.002), off * (-0.003 - 0.002)])


def test_profiles_rise_along_each_array_by_its_own_slope() -> None:
    sensor: Any = datasets.get("ccd-slit").setups["nominal"].sensor
    assert sensor.axes == ("x", "y")
    detector = replace(bare(sensor.detector), prnu=0.0, dsnu=0.0)
    sensor = replace(sensor, detector=detector)
    even, uneven = scenes()
    pattern = sensor.fixed_pattern("test")
    numbers = sensor.expected(uneven, pattern) - sensor.expected(even, pattern)
    light = numbers * detector.gain_e_per_dn / detector.sunlit_e
    columns = detector.columns
    place = (np.arange(columns) - (columns - 1) / 2.0) / (columns / 2.0)
    expected = np.concatenate([SLOPE[0] * place, SLOPE[1] * place])
    assert light == pytest.approx(np.tile(expected, (2, 1)), abs=1e-9)
