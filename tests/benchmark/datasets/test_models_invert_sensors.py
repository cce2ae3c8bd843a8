"""Simulated sensors without noise are inverted exactly by the models made for them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from algorithms.angles import separation_deg
from algorithms.pipeline import Pipeline
from benchmark import datasets
from benchmark.datasets.conditions.line_arrays import MISASSEMBLED
from benchmark.plan import combinations as plan
from benchmark.plan.parts import installed_parts
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.light_to_frequency import FrequencyCounter

POINT = SolarDisc(diameter_deg=0.0)
FACED = [
    ("pd-maskless-pyramid", "pyramidal"),
    ("pd-maskless-pyramid", "panoramic"),
    ("qpd-maskless-pyramid", "pyramidal"),
    ("pva-maskless-pyramid", "pyramidal"),
    ("pva-maskless-sphere", "panoramic"),
    ("pva-maskless-panels", "solar-panel"),
    ("pd-maskless-cube", "solar-panel"),
    ("ltf-maskless-cube", "solar-panel"),
    ("ltf-maskless-cube", "basic"),
]
DIAL = "pd-code-dial"


def error_deg(name: str, model: str, sensor: Any, built: Any = None) -> np.ndarray:
    """(N,) of the dataset's test directions, the pipeline calibrated on its calibration ones."""
    preset, parts = datasets.get(name), installed_parts()
    extractor = "dial-tracks" if name == DIAL else "direct"
    pipeline = Pipeline.for_sensor(parts.extractor(extractor), parts.model(model), preset.geometry)
    pattern = sensor.fixed_pattern("test") if built is None else built
    seen = []
    for split in ("calibration", "test"):
        sun = preset.generate("nominal", split).sun
        scene = Scene(sun, np.ones(len(sun)), np.zeros(len(sun)))
        seen.append((sensor.expected(scene, pattern), sun))
    pipeline.fit(*seen[0])
    return np.asarray(separation_deg(pipeline.predict(seen[1][0]), seen[1][1]))


def perfect_faces(name: str, **changes: Any) -> Any:
    """The dataset's sensor with cosine faces where its normals say, under the whole Sun."""
    sensor = datasets.get(name).setups["nominal"].sensor
    changes = {"response": "cosine", "normal_error_deg": 0.0, "assembly": Assembly(), **changes}
    if hasattr(sensor, "cells"):  # their current grows with their own light, which bends it
        changes["cells"] = replace(sensor.cells, heating_k=0.0, mismatch=0.0)
    readout = replace(sensor.readout, gain_mismatch=0.0, dark=DarkCurrent(0.0))
    if isinstance(readout, FrequencyCounter):
        readout = replace(readout, nonlinearity=0.0)
    return replace(sensor, **{"readout": readout, **changes})


@pytest.mark.parametrize(("name", "model"), FACED)
def test_perfect_faces_are_inverted(name: str, model: str) -> None:
    """Under a point Sun: the disc's limb alone lights faces that its middle does not."""
    error = error_deg(name, model, perfect_faces(name, sun=POINT))
    assert error.max() < 1e-6  # and not NaN: found in every direction


def test_panoramic_learns_what_each_cell_gives() -> None:
    sensor = perfect_faces("pva-maskless-sphere", sun=POINT)
    cells = replace(sensor.cells, mismatch=0.1, loss=0.2, loss_spread=0.05)
    assert error_deg("pva-maskless-sphere", "panoramic", replace(sensor, cells=cells)).max() < 1e-6


def test_sixteen_cells_have_four_lit_in_every_direction() -> None:
    """The survey's full sphere: at up to 75 degrees, brute force over a fine grid."""
    normals = np.array(datasets.get("pva-maskless-sphere").geometry.face_normals)
    z, turn = np.meshgrid(np.linspace(-1, 1, 201), np.linspace(0, 2 * math.pi, 400))
    radius = np.sqrt(1 - z**2)
    sun = np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=-1).reshape(-1, 3)
    assert (sun @ normals.T >= math.cos(math.radians(75.0))).sum(axis=1).min() == 4


def ideal_dial(**changes: Any) -> Any:
    sensor = datasets.get(DIAL).setups["nominal"].sensor
    camera = replace(
        sensor.camera,
        mask=Mask(sensor.camera.mask.apertures),
        sun=POINT,
        assembly=changes.pop("assembly", Assembly()),
    )
    dial = replace(sensor.dial, track_error_mm=0.0)
    readout = replace(sensor.readout, gain_mismatch=0.0, dark=DarkCurrent(0.0))
    return replace(
        sensor,
        **{"camera": camera, "dial": dial, "readout": readout, "deflection_deg": 0.0} | changes,
    )


@pytest.mark.parametrize("model", ["periodic", "fourier-phase"])
def test_perfect_dials_are_inverted(model: str) -> None:
    assert error_deg(DIAL, model, ideal_dial()).max() < 1e-6


@pytest.mark.parametrize("model", ["periodic", "fourier-phase"])
def test_dials_too_far_and_off_centre_are_inverted(model: str) -> None:
    away = Assembly(focal_length_error_mm=0.03, offset_x_mm=0.05, offset_y_mm=-0.04)
    assert error_deg(DIAL, model, ideal_dial(assembly=away)).max() < 1e-6


@pytest.mark.slow
def test_a_head_assembled_badly_is_a_projection() -> None:
    """Tilted, turned, off centre, too far, slits askew: the two-axis conversion is exact."""
    sensor = ideal_dial(assembly=MISASSEMBLED)
    assert error_deg(DIAL, "fourier-phase", sensor).max() < 1e-6
    assert error_deg(DIAL, "periodic", sensor).max() > 0.1


@pytest.mark.slow
def test_slits_askew_shift_every_fine_row_by_its_own_height() -> None:
    """Rows a pitch apart see the slit ``pitch tan(deflection)`` further along: a phase error.

    13 um here, whose series goes on beyond four terms, by less than 1e-5 deg.
    """
    error = error_deg(DIAL, "fourier-phase", ideal_dial(deflection_deg=0.5))
    assert error.max() < 1e-5
    assert error_deg(DIAL, "periodic", ideal_dial(deflection_deg=0.5)).max() > 0.1


@pytest.mark.slow
def test_gains_and_displaced_rows_are_in_the_series_and_partly_in_the_one_term() -> None:
    """Gain mismatch errs once a period, displaced rows twice: eq:pamulti has the second alone."""
    sensor = ideal_dial()
    pattern = dict(sensor.fixed_pattern("test"))
    rows = np.arange(18)
    fine = rows % 9 >= sensor.dial.bits
    pattern["shift_mm"] = np.where(fine & (rows % 9 % 2 == 0), 0.002, 0.0)  # F2 and F4
    skewed = {m: error_deg(DIAL, m, sensor, pattern).max() for m in ("periodic", "fourier-phase")}
    # left uncorrected: half a skew of 2 um, at 2.5 mm: 0.023 deg
    left = math.degrees(0.5 * 0.002 / 2.5)
    assert skewed["periodic"] < 0.02 * left
    assert skewed["fourier-phase"] < 0.02 * left
    pattern["gain"] = np.where(fine & (rows % 9 == 5), 1.02, 1.0)  # F1
    uneven = {m: error_deg(DIAL, m, sensor, pattern).max() for m in ("periodic", "fourier-phase")}
    assert uneven["fourier-phase"] < 0.05 * uneven["periodic"]


def test_models_of_other_bodies_say_why_they_cannot_read_a_dataset() -> None:
    direct = plan.list_exclusions(extractors=["direct", "dial-tracks"])
    reasons = {(r.dataset, r.model): r.reason for r in direct if r.model}
    assert "regular pyramid" in reasons["pva-maskless-sphere", "pyramidal"]
    assert "six panel normals" in reasons["pd-maskless-pyramid", "solar-panel"]
    assert "6 faces leave 1" in reasons["pva-maskless-panels", "panoramic"]
    assert "4 faces leave 2" in reasons["qpd-maskless-pyramid", "panoramic"]
    assert "code_bits" in reasons["pd-maskless-cube", "periodic"]
    assert "face_normals" in reasons[DIAL, "panoramic"]


def test_dark_dials_and_faces_are_not_found() -> None:
    parts = installed_parts()
    for name, extractor, model, width in (
        ("pva-maskless-sphere", "direct", "panoramic", 16),
        ("pd-maskless-pyramid", "direct", "pyramidal", 6),
        (DIAL, "dial-tracks", "periodic", 18),
        (DIAL, "dial-tracks", "fourier-phase", 18),
    ):
        preset = datasets.get(name)
        pipeline = Pipeline.for_sensor(
            parts.extractor(extractor), parts.model(model), preset.geometry
        )
        samples = preset.generate("nominal", "calibration")
        pipeline.fit(samples.observations, samples.sun)
        assert np.isnan(pipeline.predict(np.zeros((2, width)))).all()
        assert np.isfinite(pipeline.predict(samples.observations[:5])).all()


def test_beyond_the_dial_nothing_is_made_up() -> None:
    """At 75 degrees the light falls beside the dial's last cell."""
    parts, sensor = installed_parts(), ideal_dial()
    preset = datasets.get(DIAL)
    pipeline = Pipeline.for_sensor(
        parts.extractor("dial-tracks"), parts.model("periodic"), preset.geometry
    )
    sun = preset.generate("nominal", "calibration").sun
    pattern = sensor.fixed_pattern("test")
    pipeline.fit(sensor.expected(Scene(sun, np.ones(len(sun)), np.zeros(len(sun))), pattern), sun)
    away = from_angles(np.zeros(3), np.array([70.0, 75.0, -80.0]))
    found = pipeline.predict(sensor.expected(Scene(away, np.ones(3), np.zeros(3)), pattern))
    assert np.isnan(found).all()
