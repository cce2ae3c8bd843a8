"""Faces without a mask: layouts, what turns their light into signals, and its exact inversion."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import apart_deg, lit_by
from scipy.optimize import brentq

from algorithms.extractors.currents.photodiode import VoltageBalance
from benchmark import datasets
from benchmark.datasets.conditions.cone import ConeField
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent
from benchmark.simulator.sensors.face_layouts import pyramid, sphere
from benchmark.simulator.sensors.faces import CUBE, Faces
from benchmark.simulator.sensors.light_to_frequency import FrequencySensor
from benchmark.simulator.sensors.opto_isolator import OptoIsolatorSensor, collect
from benchmark.simulator.sensors.solar_cells import SolarCells, SolarCellSensor

IDEAL = CurrentReadout(100.0, 0.0, 0.0, full_scale_ua=400.0, bits=24)
POINT = SolarDisc(diameter_deg=0.0)
ANALOG = (
    "ltf-maskless-cube",
    "oi-maskless-pyramid",
    "pd-maskless-pyramid",
    "pd-single-aperture",
    "pd-slit",
    "psd-single-aperture",
    "pva-maskless-panels",
    "pva-maskless-pyramid",
    "pva-maskless-sphere",
    "qpd-maskless-pyramid",
)
BARE = tuple(name for name in ANALOG if "maskless" in name)


@pytest.mark.parametrize(("faces", "tilt"), [(3, 20.0), (6, 30.0), (7, 71.0)])
def test_pyramid_normals_are_those_of_the_survey(faces: int, tilt: float) -> None:
    """eq:msfpyra1: b = (sin a cos g, cos a cos g, sin g), a counted from +y to +x."""
    gamma = math.radians(90.0 - tilt)
    a = math.pi / 2 - 2 * math.pi * np.arange(faces) / faces
    expected = np.column_stack(
        [np.sin(a) * math.cos(gamma), np.cos(a) * math.cos(gamma), np.full(faces, math.sin(gamma))]
    )
    assert np.array(pyramid(faces, tilt)) == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("count", [16, 991])
def test_faces_spread_evenly_over_the_sphere(count: int) -> None:
    normals = np.array(sphere(count))
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)
    assert np.abs(normals.mean(axis=0)).max() < 1 / count
    assert normals.T @ normals / count == pytest.approx(np.eye(3) / 3, abs=2 / count)
    nearest = np.degrees(np.arccos(np.sort(normals @ normals.T, axis=1)[:, -2]))
    equal = math.degrees(math.sqrt(4 * math.pi / count))  # side of an equal share of the sphere
    assert nearest.min() > 0.6 * equal


def test_a_cap_holds_all_its_directions_and_none_beyond() -> None:
    field = ConeField(55.0, calibration_samples=400, test_samples=4000)
    edge = math.cos(math.radians(55.0))
    for split in ("calibration", "test"):
        z = field.sun(split, generator("test", split))[:, 2]
        assert edge < z.min() < edge + 2e-3
        assert z.mean() == pytest.approx((1 + edge) / 2, abs=0.01)  # uniform in solid angle
        assert len(z) == field.card()[split]["samples"]


def perfect(name: str) -> Any:
    """The dataset's sensor as drawn: cosine faces, no errors, a point Sun; cells stay warm."""
    sensor = datasets.get(name).setups["nominal"].sensor
    changes: dict[str, Any] = {"response": "cosine", "normal_error_deg": 0.0, "sun": POINT}
    changes["readout"] = replace(sensor.readout, gain_mismatch=0.0, dark=DarkCurrent(0.0))
    changes["assembly"] = Assembly()
    return replace(sensor, **changes)


def undone(sensor: Any, signals: np.ndarray, pattern: Any) -> np.ndarray:
    """Light (K,) on the faces, from one row of signals by each detector's own relation."""
    if isinstance(sensor, FrequencySensor):
        # the smaller root of rate (1 - n rate / 100 kHz)
        bend = sensor.readout.nonlinearity / 1e5
        straight = (1.0 - np.sqrt(1.0 - 4.0 * bend * signals)) / (2.0 * bend)
        return straight / sensor.readout.sunlit_hz
    relative = signals / sensor.readout.sunlit_ua
    if isinstance(sensor, OptoIsolatorSensor):
        current = relative * collect(np.ones(1), sensor.knee)
        return current + np.sqrt(sensor.knee / 2.0 * current)
    if isinstance(sensor, SolarCellSensor):
        # i = light (1 + c (T - 25 + h light)), a quadratic in the light
        cells = sensor.cells
        b = 1 + cells.temperature_per_k * (cells.temperature_c - 25)
        a = cells.temperature_per_k * cells.heating_k
        string = relative / pattern["cells"].min(axis=1)
        return (np.sqrt(b * b + 4 * a * string) - b) / (2 * a)
    return relative


@pytest.mark.parametrize("name", BARE)
@given(data=st.data())
@settings(deadline=None, derandomize=True, max_examples=25)
def test_least_squares_over_the_lit_faces_invert_the_perfect_sensor(
    name: str, data: st.DataObject
) -> None:
    """Three lit cosine faces or more are linear in the Sun vector."""
    half = datasets.get(name).geometry.half_fov_deg or 180.0
    z = math.cos(math.radians(data.draw(st.floats(0.0, half))))
    turn = data.draw(st.floats(0.0, 2 * math.pi))
    radius = math.sqrt(1 - z * z)
    sun = np.array([[radius * math.cos(turn), radius * math.sin(turn), z]])
    sensor = perfect(name)
    pattern = sensor.fixed_pattern("test")
    light = undone(sensor, sensor.expected(lit_by(sun), pattern)[0], pattern)
    normals = np.array(sensor.normals)
    # a dark face says its cosine is not positive: on a cube, that of the opposite face's is not
    lit = light > 1e-12
    if np.linalg.matrix_rank(normals[lit], tol=1e-6) < 3:
        return
    found = np.linalg.lstsq(normals[lit], light[lit])[0]
    assert apart_deg(found[None], sun) < 1e-6


@given(alpha=st.floats(-38.0, 38.0), beta=st.floats(-38.0, 38.0))
@settings(deadline=None, derandomize=True, max_examples=40)
def test_balances_of_a_quadrant_pyramid_are_linear_in_the_tangents(
    alpha: float, beta: float
) -> None:
    """Faces tilted by t: ``s_a = tan(t) tan(beta) / sqrt(2)`` while all four are lit."""
    sensor = perfect("qpd-maskless-pyramid")
    tangents = np.array([math.tan(math.radians(beta)), math.tan(math.radians(alpha))])
    sun = np.array([[*tangents, 1.0]]) / math.sqrt(1 + tangents @ tangents)
    seen = VoltageBalance().extract(sensor.expected(lit_by(sun), sensor.fixed_pattern("test")))
    slope = math.tan(math.radians(30.0)) / math.sqrt(2)
    found = np.array([[*(seen[0] / slope), 1.0]])
    assert seen[0] == pytest.approx(slope * tangents, abs=1e-12)
    assert apart_deg(found / np.linalg.norm(found), sun) < 1e-6


def cells(**changes: Any) -> SolarCellSensor:
    return SolarCellSensor(CUBE, IDEAL, SolarCells(**changes), response="cosine", sun=POINT)


def test_a_string_carries_the_current_of_its_weakest_cell() -> None:
    sensor = cells(in_series=3, mismatch=0.1)
    pattern = dict(sensor.fixed_pattern("test"))
    sun = np.array([[0.48, 0.6, 0.64]])
    light = np.array([0.48, 0, 0.6, 0, 0.64, 0])
    seen = sensor.expected(lit_by(sun), pattern)[0]
    assert seen == pytest.approx(
        [100 * x * min(c) for x, c in zip(light, pattern["cells"], strict=True)]
    )
    assert len(set(pattern["cells"].ravel())) == 18
    broken = pattern["cells"].copy()
    broken[4, 1] = 0.0
    dead = sensor.expected(lit_by(sun), {**pattern, "cells": broken})[0]
    assert dead[4] == 0.0
    assert dead[:4] == pytest.approx(seen[:4])


def test_longer_strings_lose_more() -> None:
    """The mean of the smallest of n Gaussians: -0.5642 sigma for two, -1.0294 for four."""
    many = tuple(sphere(3000))
    for length, loss in ((1, 0.0), (2, 0.5642), (4, 1.0294)):
        sensor = SolarCellSensor(many, IDEAL, SolarCells(length, mismatch=0.02))
        weakest = sensor.fixed_pattern("test")["cells"].min(axis=1)
        assert weakest.mean() == pytest.approx(1 - 0.02 * loss, abs=0.0015)


def test_current_changes_with_temperature_by_the_coefficient() -> None:
    """eq:tempcomp: ``I (1 + C (T - T0))``; and warmer where there is more light."""
    sun = np.array([[0.6, 0.0, 0.8]])
    plain = cells().expected(lit_by(sun), cells().fixed_pattern("test"))[0]
    hot = cells(temperature_per_k=0.0006, temperature_c=80.0)
    assert hot.expected(lit_by(sun), hot.fixed_pattern("test"))[0] == pytest.approx(
        plain * (1 + 0.0006 * 55)
    )
    warmed = cells(temperature_per_k=0.0006, heating_k=40.0)
    seen = warmed.expected(lit_by(sun), warmed.fixed_pattern("test"))[0]
    assert seen[[0, 4]] == pytest.approx([60 * (1 + 0.0006 * 24), 80 * (1 + 0.0006 * 32)])


def test_opto_isolators_gain_with_the_light_and_are_far_apart() -> None:
    sensor = OptoIsolatorSensor(sphere(3000), replace(IDEAL, gain_mismatch=0.3), sun=POINT)
    pattern = sensor.fixed_pattern("test")
    logs = np.log(pattern["gain"])
    assert logs.mean() == pytest.approx(0.0, abs=0.02)
    assert logs.std() == pytest.approx(0.3, rel=0.05)
    light = np.clip(np.array(sensor.normals)[:, 2], 0, None)
    seen = sensor.expected(lit_by(np.array([[0.0, 0.0, 1.0]])), pattern)[0]
    # what the junction's law says of the current, solved by bisection
    law = [brentq(lambda i, x=x: i + math.sqrt(0.05 * i) - x, 0.0, x + 1e-300) for x in light]
    sunlit = brentq(lambda i: i + math.sqrt(0.05 * i) - 1.0, 0.0, 1.0)
    assert seen == pytest.approx(100 * pattern["gain"] * np.array(law) / sunlit, abs=1e-9)


def test_a_phototransistor_s_gain_is_half_at_the_knee_and_goes_with_the_light_below() -> None:
    assert collect(np.array([0.2]), 0.2)[0] / 0.2 == pytest.approx(0.5)
    small = collect(np.array([1e-6, 2e-6]), 0.2)
    assert small[1] / small[0] == pytest.approx(4.0, rel=1e-4)
    much = collect(np.array([1e4, 2e4]), 0.2)
    assert much[1] / much[0] == pytest.approx(2.0, rel=2e-3)
    assert collect(np.array([-1.0, 0.0, 0.7]), 0.0) == pytest.approx([0.0, 0.0, 0.7])
    with pytest.raises(ValueError, match=r"knee.*-1"):
        OptoIsolatorSensor(CUBE, IDEAL, knee=-1.0)


@pytest.mark.parametrize("name", BARE)
def test_earthlight_reaches_each_face_by_its_own_normal(name: str) -> None:
    """As light, before the detector makes a signal of it; on the test split alone."""
    preset = datasets.get(name)
    sensor = preset.setups["albedo"].sensor
    assert isinstance(sensor, Faces)
    assert preset.scene("albedo", "calibration").albedo is None
    scene = preset.scene("albedo", "test").part(0, 20)
    assert scene.albedo is not None
    pattern = preset.fixed_pattern("albedo")
    assert scene.albedo.shape == (20, len(sensor.normals))
    assert 0.05 < scene.albedo.max() < 0.4
    assert sensor.receive(scene, pattern) == pytest.approx(
        sensor.lit(scene, pattern) + scene.stray[:, None] + scene.albedo
    )
    sun, nadir = np.array([[0.0, 0, 1.0]]), np.array([[0.0, 0.6, -0.8]])
    light = sensor.earthlight(Earth(), sun, nadir, pattern)[0]
    expected = Earth().response(sun, nadir, pattern["normals"], sensor.response)[0]
    if sensor.assembly == Assembly():
        assert light == pytest.approx(expected)
    facing = pattern["normals"] @ nadir[0]
    brightest = pattern["normals"][light.argmax()] @ nadir[0]
    assert brightest > np.sort(facing)[-3:].min() - 1e-12
