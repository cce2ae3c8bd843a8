"""Sensors of single studies: apart from the standard ones, as their descriptions say."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from algorithms.compensations.environment.temperature import TemperatureDrift
from benchmark import datasets
from benchmark.datasets.conditions.thermal_chamber import Chamber
from benchmark.simulator.flight.drift import REFERENCE_K
from benchmark.simulator.light.environment import Irradiance
from registry.studies import facts

NAMES = datasets.study_names()
CHAMBER: Any = datasets.get("pd-maskless-two-pyramids")
CAMERAS = [name for name in NAMES if name.startswith("cmos-single-aperture-")]


@pytest.mark.parametrize("name", NAMES)
def test_each_is_made_after_a_study_and_says_what_is_assumed(name: str) -> None:
    preset = datasets.get(name)
    assert preset.follows
    assert set(preset.follows) <= set(facts().studies)
    assert "Assumed" in preset.description
    assert any(key in preset.description for key in preset.follows)


@pytest.mark.parametrize("name", CAMERAS)
def test_the_spot_stays_on_the_array_all_over_the_field(name: str) -> None:
    geometry = datasets.get(name).geometry
    half_array = (geometry.centre_px[0] + 0.5) * geometry.pixel_pitch_mm
    farthest = geometry.focal_length_mm * math.tan(math.radians(geometry.half_fov_deg))
    assert farthest + geometry.aperture_width_mm / 2.0 < half_array


@pytest.mark.parametrize("name", CAMERAS)
def test_no_pixel_is_full(name: str) -> None:
    preset = datasets.get(name)
    for condition in preset.conditions:
        detector: Any = preset.condition(condition).sensor
        detector = detector.detector
        full = detector.offset_dn + detector.full_well_e / detector.gain_e_per_dn
        brightest = preset.generate(condition, "test", 60).observations.max()
        assert brightest < min(full, 2**detector.bits - 1)


def test_faces_of_a_pyramid_stand_at_the_tilt_that_is_drawn() -> None:
    normals = np.array(CHAMBER.geometry.face_normals)
    for axis in (np.ones(3), -np.ones(3)):
        cosines = normals @ (axis / math.sqrt(3.0))
        near = np.sort(cosines)[3:]
        tilt = np.degrees(np.arccos(near))
        np.testing.assert_allclose(tilt, CHAMBER.drawn["tilt_deg"], atol=1e-9)


@pytest.mark.parametrize(
    ("condition", "split", "low_c", "high_c"),
    [
        ("nominal", "calibration", -20.0, 40.0),
        ("nominal", "test", -20.0, 40.0),
        ("hot", "calibration", -20.0, 40.0),
        ("hot", "test", 60.0, 80.0),
        ("hot", "repeat", 60.0, 80.0),
    ],
)
def test_a_chamber_has_the_temperatures_that_it_says(
    condition: str, split: str, low_c: float, high_c: float
) -> None:
    samples = CHAMBER.generate(condition, split)
    read = samples.context["temperature_K"] - 273.15
    assert read.shape == (len(samples.sun),)
    assert low_c - 5.0 < read.min() < low_c + 5.0  # a thermometer's bias is a kelvin
    assert high_c - 5.0 < read.max() < high_c + 5.0
    assert CHAMBER.context_columns == ("temperature_K",)


def test_the_temperature_coefficients_are_those_of_the_unit() -> None:
    """What the compensation learns of readings without noise is what the unit was drawn with."""
    ground = CHAMBER.condition("nominal")
    exact = Chamber((-20.0, 40.0), (-20.0, 40.0))
    quiet = dataclasses.replace(
        ground.sensor,
        response="cosine",
        normal_error_deg=0.0,
        readout=dataclasses.replace(
            ground.sensor.readout,
            noise_ua=1e-6,
            bits=24,
            dark=dataclasses.replace(ground.sensor.readout.dark, at_25_c=0.0),
        ),
    )
    setup = dataclasses.replace(ground, sensor=quiet, bench=None, irradiance=Irradiance(spread=0.0))
    preset = dataclasses.replace(CHAMBER, setups={"nominal": setup}, chambers={"nominal": exact})
    samples = preset.generate("nominal", "calibration")
    warm = preset.scene("nominal", "calibration").temperature_k
    drift = TemperatureDrift(preset.geometry.face_normals)
    drift.fit(samples.observations, samples.sun, {"temperature_K": warm})
    drawn = preset.fixed_pattern("nominal")["gain_per_k"]
    # relative to the level at the mean temperature, not at 25 deg C
    level = 1.0 + drawn * (drift.reference_k_ - REFERENCE_K)
    np.testing.assert_allclose(drift.coefficients_, drawn / level, rtol=0.01)
