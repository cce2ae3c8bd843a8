"""Flats and darks: what they say of a unit's elements, and what stays unknown."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmark import datasets
from benchmark.metrics.bounds import cramer_rao
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import (
    References,
    pixel_references,
    pixel_spread,
    pixel_unit_variance,
    posterior,
    readings_information,
)
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import UnitSpread
from benchmark.simulator.sensors.lit_pixels import LitPixels

PIXELS = PixelArray(
    columns=200, rows=100, pitch_mm=0.01, sunlit_e=20_000, full_well_e=30_000, prnu=0.02, dsnu=0.3,
    dark=DarkCurrent(2_000.0), exposure_s=0.5, read_noise_e=30.0, gain_e_per_dn=30.0,
    offset_dn=20.0, bits=10,
)  # fmt: skip
POSITIVE = st.floats(-3, 3).map(lambda power: 10.0**power)


def unit(detector: PixelArray = PIXELS) -> dict[str, np.ndarray]:
    draws = np.random.default_rng(5).standard_normal((2, detector.rows, detector.columns))
    dark = detector.dark.level() * detector.exposure_s
    return {
        "gain": 1 + detector.prnu * draws[0],
        "dark_e": dark * (1 + detector.dsnu * draws[1]),
    }


@given(POSITIVE, POSITIVE, POSITIVE, POSITIVE, POSITIVE)
def test_what_is_left_is_the_inverse_of_all_information(
    gain: float, dark: float, light: float, flats: float, darks: float
) -> None:
    row = np.array([[light, 1.0]])
    whole = np.diag([gain**-2, dark**-2 + darks]) + flats * row.T @ row
    exact = np.linalg.inv(whole)
    found = posterior((gain, dark), light, (flats, darks))
    # the inverse loses as many digits as its condition has
    near = 1e-13 * np.linalg.cond(whole)
    assert found.gain == pytest.approx(exact[0, 0], rel=near)
    assert found.dark == pytest.approx(exact[1, 1], rel=near)
    assert found.cross == pytest.approx(
        exact[0, 1], rel=near, abs=near * math.sqrt(exact[0, 0] * exact[1, 1])
    )


@pytest.mark.parametrize("deviation", [0.8, 2.0, 50.0])
def test_readings_of_much_noise_average_with_their_twelfth(deviation: float) -> None:
    assert readings_information(deviation, 16) == pytest.approx(
        16 / (deviation**2 + 1 / 12), rel=1e-4
    )


def test_readings_without_noise_tell_their_code_however_often() -> None:
    for count in (1, 16, 10_000):
        assert readings_information(0.0, count) == pytest.approx(12.0)
        assert readings_information(1e-4, count) == pytest.approx(12.0, rel=0.01)
    assert readings_information(0.0, 0) == 0.0


def test_the_pixels_estimated_by_flats_and_darks_are_wrong_by_what_is_left() -> None:
    """Two linear equations a pixel, solved by plain least squares: noise far below the spread."""
    references = References(flats=16, darks=16)
    pattern = unit()
    readings = pixel_references(PIXELS, pattern, references, NoiseStreams.named("test", "flats"))
    per_dn, dark_e = PIXELS.gain_e_per_dn, 1_000.0
    light = 0.5 * (PIXELS.full_well_e - dark_e) / per_dn  # the full well ends the scale
    dark = readings["dark_dn"] - PIXELS.offset_dn
    gain = (readings["flat_dn"] - readings["dark_dn"]) / light
    spread = pixel_spread(PIXELS, dark_e, references)
    errors = {
        "gain": (gain - pattern["gain"], spread.gain),
        "dark": (dark - pattern["dark_e"] / per_dn, spread.dark),
    }
    for name, (error, left) in errors.items():
        # priors narrow what least squares reaches, by less than a tenth here
        assert error.std() == pytest.approx(math.sqrt(left), rel=0.1), name
        assert abs(error.mean()) < 5 * error.std() / math.sqrt(error.size), name
    signal = 400.0
    wrong = signal * errors["gain"][0] + errors["dark"][0]
    mean = np.array(PIXELS.offset_dn + dark_e / per_dn + signal)
    left = pixel_unit_variance(PIXELS, mean, references)
    assert wrong.std() == pytest.approx(math.sqrt(float(left)), rel=0.1)


@pytest.mark.parametrize(
    "name",
    [
        "ccd-slit", "qpd-single-aperture", "psd-single-aperture", "pd-slit", "pd-code-dial",
        "pd-maskless-cube", "oi-maskless-pyramid", "pva-maskless-sphere", "ltf-maskless-cube",
    ],
)  # fmt: skip
def test_flats_show_each_element_s_own_gain(name: str) -> None:
    """Flats less darks are proportional to the gains, to what noise is left in 400 of each."""
    preset = datasets.get(name)
    preset = replace(preset, offered=References(flats=400, darks=400))
    condition = preset.conditions[0]
    sensor, pattern = preset.setups[condition].sensor, preset.fixed_pattern(condition)
    assert isinstance(sensor, UnitSpread)
    found = preset.references(condition)
    (dark,), (flat,) = ([v for k, v in found.items() if k.startswith(w)] for w in ("dark", "flat"))
    gain = pattern["gain"] * (pattern["cells"].min(axis=1) if "cells" in pattern else 1.0)
    ratio = (flat - dark) / gain
    assert ratio == pytest.approx(np.full(len(gain), ratio.mean()), rel=0.002)
    again = preset.references(condition)
    for key, array in found.items():
        np.testing.assert_array_equal(again[key], array)


def test_another_unit_has_other_references_and_a_sensor_without_elements_none() -> None:
    preset = datasets.get("ccd-slit")
    condition = preset.conditions[0]
    own, other = (preset.for_unit(n).references(condition)["flat_dn"] for n in (0, 1))
    assert own.shape == other.shape == (2 * 1024,)
    assert (own != other).mean() > 0.9
    assert datasets.get("event-single-aperture").references("nominal") == {}
    with pytest.raises(ValueError, match="no condition 'nowhere'"):
        preset.references("nowhere")


def test_lit_pixels_know_as_little_of_a_unit_as_the_whole_frame() -> None:
    """Pixels far from light enter as one mean, whose share of the unit averages out as well."""
    wide: Any = datasets.get("cmos-multi-aperture").setups["nominal"].sensor
    camera = Camera(0.4, Mask(apertures=(Aperture("round", 0.1, 0.1),)))
    detector = replace(wide.detector, columns=80, rows=70, prnu=0.05)
    sensor = replace(wide, camera=camera, detector=detector, spectrum=None)
    scene = Scene(
        from_angles(np.array([0.0, 12.0]), np.array([3.0, -20.0])),
        np.ones(2), np.full(2, 0.002), np.zeros((2, 2), int),
    )  # fmt: skip
    pattern = sensor.fixed_pattern("unit")
    light = Irradiance(spread=0.02, stray=0.002, stray_spread=5e-4)
    for offered in (References(0, 0), References()):
        whole, lit = (
            cramer_rao(seen, scene, pattern, light, references=offered)
            for seen in (sensor, LitPixels(sensor, scene, pattern))
        )
        assert whole.unit_angle_deg is not None
        assert lit.unit_angle_deg == pytest.approx(whole.unit_angle_deg, rel=1e-3)
        assert (whole.unit_angle_deg > whole.angle_deg).all()
