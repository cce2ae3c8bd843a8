"""Sloping stray light, and plane glass of several layers against Snell and Fresnel."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from bare_pixels import bare
from hypothesis import given, settings
from hypothesis import strategies as st
from shadows import shadows

from benchmark import datasets
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.simulator.sensors.uneven_frames import (
    UnevenFrameSensor,
    UnevenIrradiance,
    UnevenScene,
)

NAME = "cmos-single-aperture-pinhole"


def sensors() -> tuple[FrameSensor, UnevenFrameSensor]:
    base = datasets.get("cmos-single-aperture").setups["nominal"].sensor
    detector = replace(bare(base.detector), prnu=0.0, dsnu=0.0)
    even = shadows(base, detector=detector)
    return even, UnevenFrameSensor(even.camera, detector, even.window_px, even.window_jitter_px)


def scenes(slope: tuple[float, float]) -> tuple[Scene, UnevenScene]:
    sun = np.array([[0.0, 0.0, 1.0], [0.3, 0.2, math.sqrt(0.87)]])
    even = Scene(sun, np.ones(2), np.full(2, 0.01), np.array([[224, 224], [320, 290]]))
    return even, UnevenScene.of(even, np.tile(slope, (2, 1)))


def test_slope_adds_a_plane_that_is_zero_in_the_detectors_middle() -> None:
    even_sensor, sensor = sensors()
    even, uneven = scenes((0.002, -0.001))
    added = sensor.lit(uneven) - even_sensor.lit(even)
    y, x = np.mgrid[:64, :64]
    for frame, (left, top) in zip(added, even.origin_px, strict=True):
        plane = 0.002 * (x + left - 255.5) / 256 - 0.001 * (y + top - 255.5) / 256
        assert frame == pytest.approx(plane, abs=1e-12)
    pattern = sensor.fixed_pattern("test")
    electrons = sensor.expected(uneven, pattern) - even_sensor.expected(even, pattern)
    electrons *= sensor.detector.gain_e_per_dn
    assert electrons == pytest.approx(added * sensor.detector.sunlit_e, abs=1e-8)


def test_even_scenes_and_even_sensors_know_no_slope() -> None:
    even_sensor, sensor = sensors()
    even, uneven = scenes((0.002, -0.001))
    assert np.array_equal(sensor.lit(even), even_sensor.lit(even))
    assert np.array_equal(sensor.lit(scenes((0.0, 0.0))[1]), even_sensor.lit(even))
    part = uneven.part(1, 2)
    assert np.array_equal(sensor.lit(part), sensor.lit(uneven)[1:])
    moved = uneven.seen_from(uneven.sun)
    assert isinstance(moved, UnevenScene)
    assert np.array_equal(sensor.lit(moved), sensor.lit(uneven))
    with pytest.raises(ValueError, match=r"slopes.*\(2.*2\).*\(1.*2\)"):
        UnevenScene.of(even, np.zeros((1, 2)))


def test_slopes_are_drawn_with_their_spread_from_a_stream_of_their_own() -> None:
    light = UnevenIrradiance(stray=0.02, stray_spread=0.001, slope_spread=0.004)
    slopes = light.draw_slopes(20_000, generator("test", "slopes"))
    assert slopes.std(axis=0) == pytest.approx(0.004, rel=0.02)
    assert abs(np.corrcoef(slopes.T)[0, 1]) < 0.03
    plain = Irradiance(stray=0.02, stray_spread=0.001)
    for drawn, other in zip(
        light.draw(5, generator("test")), plain.draw(5, generator("test")), strict=True
    ):
        assert np.array_equal(drawn, other)
    preset = datasets.get(NAME)
    sloping, nominal = (preset.scene(c, "test") for c in ("stray-gradient", "nominal"))
    assert isinstance(sloping, UnevenScene)
    assert type(nominal) is Scene
    assert sloping.slope is not None
    assert sloping.slope.std() == pytest.approx(5e-5, rel=0.06)
    for name in ("sun", "irradiance", "origin_px"):
        assert np.array_equal(getattr(sloping, name), getattr(nominal, name)), name
    with pytest.raises(ValueError, match=r"slope_spread.*\[0.*/ 4 = 0.005\]"):
        UnevenIrradiance(stray=0.02, slope_spread=0.006)


angles = st.floats(0.0, 85.0)
indices = st.floats(1.0, 2.2)


def ray(theta_deg: float) -> np.ndarray:
    theta = math.radians(theta_deg)
    return np.array([[math.sin(theta), 0.0, math.cos(theta)]])


def amplitudes(theta: float, before: float, after: float) -> tuple[float, float]:
    """Fresnel's reflection coefficients in the forms with sines and tangents of the angles."""
    inside = math.asin(before * math.sin(theta) / after)
    if theta == 0.0:
        return (before - after) / (before + after), (after - before) / (after + before)
    return (
        -math.sin(theta - inside) / math.sin(theta + inside),
        math.tan(theta - inside) / math.tan(theta + inside),
    )


@given(st.floats(1.0, 80.0), indices, indices, indices)
@settings(deadline=None, derandomize=True)
def test_layers_pass_what_each_surface_passes(theta: float, n1: float, n2: float, n3: float):
    plates = tuple(Plate(0.1, n) for n in (n1, n2, n3))
    passed = [1.0, 1.0]
    angle, before = math.radians(theta), 1.0
    for after in (n1, n2, n3, 1.0):
        for kind, amplitude in enumerate(amplitudes(angle, before, after)):
            passed[kind] *= 1.0 - amplitude**2
        angle, before = math.asin(before * math.sin(angle) / after), after
    assert angle == pytest.approx(math.radians(theta), abs=1e-7)
    found = CoverGlass(plates).transmission(ray(theta))[0]
    assert found == pytest.approx(sum(passed) / 2.0, abs=1e-9)


@given(st.floats(1.05, 2.2))
@settings(deadline=None, derandomize=True)
def test_one_polarisation_passes_whole_at_brewsters_angle(index: float) -> None:
    """There the other loses ``((n^2 - 1) / (n^2 + 1))^2`` at each surface."""
    brewster = math.degrees(math.atan(index))
    other = (1.0 - ((index**2 - 1.0) / (index**2 + 1.0)) ** 2) ** 2
    found = CoverGlass((Plate(0.5, index),)).transmission(ray(brewster))[0]
    assert found == pytest.approx((1.0 + other) / 2.0, rel=1e-12)
    assert amplitudes(math.atan(index), 1.0, index)[1] == pytest.approx(0.0, abs=1e-12)


@given(angles, indices, indices, st.floats(0.01, 0.5), st.floats(0.01, 0.5))
@settings(deadline=None, derandomize=True)
def test_order_and_splitting_of_layers_do_not_move_the_spot(theta, n1, n2, t1, t2) -> None:
    one, two = Plate(t1, n1), Plate(t2, n2)
    expected = CoverGlass((one, two)).displacement(ray(theta), 2.0)
    assert CoverGlass((two, one)).displacement(ray(theta), 2.0) == pytest.approx(expected)
    halves = Plate(t1 / 2.0, n1)
    split = CoverGlass((halves, two, halves))
    assert split.displacement(ray(theta), 2.0) == pytest.approx(expected)
    inside = [math.asin(math.sin(math.radians(theta)) / n) for n in (n1, n2)]
    snell = t1 * math.tan(inside[0]) + t2 * math.tan(inside[1])
    snell += (2.0 - t1 - t2) * math.tan(math.radians(theta))
    assert expected[0] == pytest.approx([snell, 0.0], rel=1e-9, abs=1e-12)
    whole = CoverGlass((Plate(t1, n1),)).transmission(ray(theta))
    assert CoverGlass((halves, halves)).transmission(ray(theta)) == pytest.approx(whole)
