"""Position-sensitive devices, slit pairs and glued windows against their exact geometry."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import apart_deg, lit_by, toward

from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.geometric.standard_projection import StandardProjection
from algorithms.pipeline import Pipeline
from benchmark import datasets
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.sensors.position_sensitive import (
    LateralEffect,
    aperture_rule,
)
from benchmark.simulator.sensors.slit_pairs import DiodePair

IDEAL = CurrentReadout(100.0, 0.0, 0.0, full_scale_ua=200.0, bits=24)
POINT = SolarDisc(diameter_deg=0.0)

field_angle = st.floats(-60.0, 60.0)
field_share = st.floats(-1.0, 1.0)


def perfect(name: str, **detector: Any) -> Any:
    """The dataset's sensor as drawn: no errors, no noise, a point Sun."""
    sensor = datasets.get(name).setups["nominal"].sensor
    camera = replace(sensor.camera, assembly=Assembly(), sun=POINT)
    thin = replace(camera.mask, thickness_mm=0.0)
    return replace(sensor, camera=replace(camera, mask=thin), readout=IDEAL, **detector)


def balances(sensor: Any, sun: np.ndarray) -> np.ndarray:
    return VoltageBalance().extract(sensor.expected(lit_by(sun), sensor.fixed_pattern("test")))


@pytest.mark.parametrize(
    ("name", "detector"),
    [
        ("psd-single-aperture", {"detector": LateralEffect(4.0)}),
        ("pd-slit", {"pair": DiodePair(2.9, 2.0)}),
    ],
)
@given(across=field_share, along=field_share)
@settings(deadline=None, derandomize=True, max_examples=40)
def test_the_drawing_inverts_the_perfect_sensor(
    name: str, detector: dict[str, Any], across: float, along: float
) -> None:
    """alg:VB and eq:stdproj with the dataset's own geometry: X = S L / 2, X = S sqrt(2) w / 2."""
    geometry = datasets.get(name).geometry
    edge = geometry.half_fov_deg
    sensor, sun = perfect(name, **detector), toward(edge * along, edge * across)
    drawing = Pipeline.for_sensor(VoltageBalance, StandardProjection, geometry)
    currents = sensor.expected(lit_by(sun), sensor.fixed_pattern("test"))
    drawing.fit(np.repeat(currents, 3, axis=0), np.repeat(sun, 3, axis=0))
    assert apart_deg(drawing.predict(currents), sun) < 1e-6


@given(alpha=field_angle, beta=field_angle)
@settings(deadline=None, derandomize=True, max_examples=40)
def test_snell_inverts_a_window_glued_on_its_photodiodes(alpha: float, beta: float) -> None:
    """Under glass of index n the spot lies at t tan(theta'), sin(theta) = n sin(theta')."""
    sensor = perfect("pd-single-aperture")
    sensor = replace(sensor, detector=replace(sensor.detector, gap_mm=0.0))
    sun = toward(alpha, beta)
    spot = balances(sensor, sun)[0] * 0.8 / 2
    sines = 1.52 * spot / math.sqrt(spot @ spot + 0.5**2)
    found = np.array([*sines, math.sqrt(1 - sines @ sines)])
    assert apart_deg(found[None], sun) < 1e-6


@given(x=st.floats(-0.9, 0.9), y=st.floats(-0.9, 0.9), kappa=st.floats(0.0, 0.05))
@settings(deadline=None, derandomize=True)
def test_a_nonlinear_device_divides_light_as_if_it_fell_elsewhere(
    x: float, y: float, kappa: float
) -> None:
    device = LateralEffect(4.0, kappa)
    shares = device.shares(np.array([2.0 * x]), np.array([2.0 * y]))
    assert shares.sum() == pytest.approx(1.0)
    found = VoltageBalance().extract(shares)[0]
    shrink = 1 - kappa * (x * x + y * y)
    assert found == pytest.approx([x * shrink, y * shrink], abs=1e-12)
    # and back: the radius solves r (1 - kappa r^2) = r', one root below 1 / sqrt(3 kappa)
    radius = math.hypot(*found)
    true = radius
    for _ in range(60):
        true = radius + kappa * true**3
    assert true == pytest.approx(math.hypot(x, y), abs=1e-6)


def test_a_noiseless_nonlinear_device_is_inverted_through_its_own_relation() -> None:
    sensor = perfect("psd-single-aperture")
    tiny = Mask((Aperture("round", 1e-5, 1e-5),))
    sensor = replace(sensor, camera=replace(sensor.camera, mask=tiny))
    sun = from_angles(np.array([0.0, 20.0, -42.0, 45.0]), np.array([10.0, -35.0, 40.0, 45.0]))
    seen = balances(sensor, sun)
    place = seen.copy()
    for _ in range(200):
        place = seen / (1 - 0.01 * np.sum(place**2, axis=1, keepdims=True))
    tangents = place * 4.0 / 2 / 1.5
    found = np.column_stack([tangents, np.ones(4)])
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    assert apart_deg(found, sun) < 1e-6


@pytest.mark.parametrize(
    "aperture",
    [
        Aperture("round", 0.6, 0.6, 0.1, -0.2),
        Aperture("rectangle", 0.9, 0.5, -0.3, 0.1, rotation_deg=25.0),
    ],
)
def test_a_finite_spot_divides_as_the_mean_over_its_area(aperture: Aperture) -> None:
    device = LateralEffect(4.0, 0.04)
    points, weights = aperture_rule(aperture)
    assert weights.sum() == pytest.approx(1.0)
    spot = (0.8, -1.1)
    found = weights @ device.shares(points[:, 0] + spot[0], points[:, 1] + spot[1])
    step = (np.arange(800) + 0.5) / 800 - 0.5
    p, q = np.meshgrid(step * aperture.width_mm, step * aperture.height_mm)
    inside = np.ones_like(p, dtype=bool)
    if aperture.shape == "round":
        inside = p**2 + q**2 <= (aperture.width_mm / 2) ** 2
    c, s = (
        math.cos(math.radians(aperture.rotation_deg)),
        math.sin(math.radians(aperture.rotation_deg)),
    )
    x, y = aperture.x_mm + c * p - s * q + spot[0], aperture.y_mm + s * p + c * q + spot[1]
    dense = device.shares(x[inside], y[inside]).mean(axis=0)
    assert found == pytest.approx(dense, abs=2e-6)


def test_the_spot_of_the_whole_sun_is_brighter_where_the_sun_is_higher() -> None:
    """First order in the Sun's size the balance is the ray's; all light is counted once."""
    sensor = replace(perfect("psd-single-aperture"), detector=LateralEffect(4.0))
    sensor = replace(sensor, camera=replace(sensor.camera, sun=SolarDisc()))
    sun = toward(30.0, -45.0)
    light = sensor.lit(lit_by(sun))[0]
    assert light.sum() == pytest.approx(sun[0, 2], rel=1e-4)
    assert balances(sensor, sun)[0] == pytest.approx(
        [1.5 * math.tan(math.radians(a)) / 2.0 for a in (-45.0, 30.0)], abs=1e-4
    )


@pytest.mark.parametrize("condition", datasets.get("psd-single-aperture").conditions)
def test_the_spot_stays_on_the_device_all_over_the_field(condition: str) -> None:
    sensor = datasets.get("psd-single-aperture").setups[condition].sensor
    axis = np.array([-45.0, -45.0, 45.0, 45.0, 0.0])
    sun = from_angles(axis, axis[[1, 2, 3, 0, 4]])
    head = sensor.camera.assembly.to_head(sun)
    assert sensor.lit(lit_by(sun)).sum(axis=1) == pytest.approx(head[:, 2], rel=1e-3)


@given(alpha=st.floats(-50.0, 50.0), beta=st.floats(-50.0, 50.0))
@settings(deadline=None, derandomize=True, max_examples=40)
def test_a_thick_slit_narrows_the_strip_of_light(alpha: float, beta: float) -> None:
    """Chang2006: the walls take t |tan| of the width, the middle stays; each pair for itself."""
    sensor = perfect("pd-slit", pair=DiodePair(3.5, 0.2))
    thick = replace(sensor.camera.mask, thickness_mm=0.1)
    sensor = replace(sensor, camera=replace(sensor.camera, mask=thick))
    sun = toward(alpha, beta)
    q1, q2, q3, q4 = sensor.lit(lit_by(sun))[0]
    x, y = math.tan(math.radians(beta)), math.tan(math.radians(alpha))
    for plus, minus, tangent in (
        (q2, q4, (x + y) / math.sqrt(2)),
        (q1, q3, (y - x) / math.sqrt(2)),
    ):
        width = 2.8 - 0.1 * abs(tangent)
        assert plus + minus == pytest.approx(width * 0.2 / (2 * 2.8 * 5.0) * sun[0, 2])
        assert (plus - minus) / (plus + minus) == pytest.approx(2 * 0.5 * tangent / width)
