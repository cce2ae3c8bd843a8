"""Files of a corrected calibration: code, vectors and report are those of the corrected sensor."""

from __future__ import annotations

import json
import shutil
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import bench
import numpy as np
import pytest
from raw_sensors import FLAGS, SENSORS, apart_deg, c_answers, compiled, module_of, written

from calibrate.calibration import Calibration
from calibrate.documents import SavedCalibration, document, load, of_document, with_correction
from calibrate.flight.code import corrected_code, flight_code
from calibrate.flight.program import NoCodeError, program_of, stored_program
from calibrate.places import Grazing
from calibrate.readings import Readings, readings_of
from calibrate.recalibration import Correction, Errors
from calibrate.table import Table
from calibrate.uncertainty import Intervals

ERRORS = Errors(1.0, 1.0, 1.0, 1.0)
TURN = bench.turn("z", 70.0) @ bench.turn("x", 3.0)
CUBE = np.vstack([np.eye(3), -np.eye(3)])


def uneven(grazing: Grazing) -> Intervals:
    """An uncertainty that differs between places and axes."""
    table = np.random.default_rng(1).uniform(0.1, 0.6, (5, 4, 2))
    table[0] = table[0, 0]
    rings = np.linspace(0.0, 180.0, 5)
    return Intervals(1.0, 0.95, 400, np.array([0.0, 0.0, 1.0]), rings, 4, table, grazing)


def corrected(kind: str, camera: Calibration, rotation: np.ndarray = TURN) -> SavedCalibration:
    """A calibration whose sensor changed gains, dark levels and its attitude."""
    sensor = SENSORS[kind]
    grazing = Grazing(CUBE, 0.05, 8.0) if kind == "six faces" else Grazing.none()
    found = replace(sensor.calibrated(camera), intervals=uneven(grazing))
    old = of_document(document(found, "", flight_code(found).program), kind)
    count = len(sensor.columns)
    gain = 1.0 + 0.03 * np.sin(np.arange(count))
    offset = 0.01 * np.cos(np.arange(count)) * (100.0 if kind == "spots" else 1.0)
    turned = tuple(tuple(float(c) for c in row) for row in rotation)
    change = Correction(
        ("gain", "boresight"), tuple(map(float, gain)), tuple(map(float, offset)), turned,
        ERRORS, ERRORS, (), 12,
    )  # fmt: skip
    return of_document(json.loads(json.dumps(with_correction(old, change, []))), kind)


def poses(kind: str, saved: SavedCalibration, seed: int) -> tuple[np.ndarray, Readings]:
    """Rows in the file's order and what a calibration's settings make of them."""
    sensor, stated = SENSORS[kind], saved.settings
    telemetry = sensor.telemetry(seed)
    names = [*sensor.columns, *(["temp_C"] if sensor.drift is not None else [])]
    columns = dict(zip(names, telemetry.T, strict=True))
    # any direction will do: it is not read
    columns |= {name: np.full(len(telemetry), 3.0**-0.5) for name in stated.direction.columns}
    return telemetry, readings_of(Table(columns, 2, "new", {}), stated)


@pytest.mark.parametrize("kind", ["spots", "quadrants", "warm faces"])
def test_code_of_a_corrected_calibration_answers_what_its_document_does(
    kind: str, camera: Calibration, tmp_path: Path
) -> None:
    saved = corrected(kind, camera)
    rows, read = poses(kind, saved, 6)
    assert len(read) == len(rows)
    code = corrected_code(saved, read.only(np.arange(60)))
    assert code.judged_on == "of the new poses"
    module = module_of(written(code, tmp_path))
    count = len(SENSORS[kind].columns)
    kelvin = rows[:, count] if rows.shape[1] > count else None
    said = module.solve(rows[:, :count], kelvin)
    expected = saved.predict(read.features, read.context)
    good = (said["status"] == 0) & np.isfinite(expected[:, 0])
    assert good.mean() > 0.5
    off = apart_deg(said["sun"][good], expected[good])
    assert np.sqrt(np.mean(off**2)) < 0.01 * saved.stated_deg
    stated = saved.deviations_deg(read.features, read.context)[good]
    assert np.median(np.abs(said["sigma_deg"][good] / stated - 1.0)) < 1e-3
    assert module.selftest()[0] == 0
    unturned = replace(saved, rotation=np.eye(3)).predict(read.features, read.context)
    assert np.nanmedian(apart_deg(unturned, expected)) > 3.0


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler here")
def test_c_of_a_corrected_calibration_answers_what_python_does(
    camera: Calibration, tmp_path: Path
) -> None:
    saved = corrected("six faces", camera)
    rows, read = poses("six faces", saved, 6)
    module = module_of(written(corrected_code(saved, read), tmp_path))
    compiled(tmp_path, "gcc", *FLAGS, "-DSS_SELFTEST", "ss.c", "ss_selftest.c", "-o", "own", "-lm")
    assert " 0 differ from the model" in compiled(tmp_path, "./own")
    answers = c_answers(tmp_path, rows)
    made = module.solve(rows)
    assert np.array_equal(made["status"], answers[:, 0].astype(int))
    good = answers[:, 0] == 0
    assert np.max(apart_deg(made["sun"][good], answers[good, 1:4])) < 1e-9
    assert answers[good, 4:6] == pytest.approx(made["angle_deg"][good], abs=1e-7)
    assert answers[good, 6:8] == pytest.approx(made["sigma_deg"][good], rel=2e-5)


def test_no_code_is_written_for_a_document_without_a_program(camera: Calibration) -> None:
    saved = corrected("six faces", camera)
    del saved.document["flight"]
    with pytest.raises(NoCodeError, match="holds no program"):
        corrected_code(saved, poses("six faces", saved, 6)[1])


@pytest.mark.parametrize(
    "change",
    [
        {"steps": [{"name": "readings"}]},
        {"steps": None},
        {"columns": None},
        {"columns": ["a", False]},
        {"columns": "six names"},
        {"columns": ["a"]},
        {"columns": ["a", "b", "c", "d", "e", "f", "g"]},
        {"thermometer": {"column": 1, "unit": "K", "scale": 1.0, "offset": 0.0}},
        {"thermometer": {"column": "t", "unit": "degC", "scale": 1.0, "offset": 0.0}},
        {"words": "\x1b[2J"},
        {"words": 3},
    ],
)
def test_a_damaged_program_is_refused(camera: Calibration, change: dict[str, Any]) -> None:
    stored = stored_program(flight_code(SENSORS["six faces"].calibrated(camera)).program)
    with pytest.raises(NoCodeError, match="damaged"):
        program_of(stored | change)
    stored["steps"][0]["constants"]["place"] = [0.0] * 6
    with pytest.raises(NoCodeError, match="damaged"):
        program_of(stored)


def test_a_program_that_would_write_statements_of_its_own_is_refused(camera: Calibration) -> None:
    """Names of constants stand in C, and a unit in Python, as the document has them."""
    stored = stored_program(flight_code(SENSORS["six faces"].calibrated(camera)).program)
    statement = "x[1] = { 0 }; void own(void) { system(NULL); } static const int y"
    stored["steps"][0]["constants"][statement] = [1.0]
    with pytest.raises(NoCodeError, match="damaged: expected the constants of a step"):
        program_of(stored)
    del stored["steps"][0]["constants"][statement]
    program_of(stored)
    unit = '""" and print("of its own") or """'
    warm = {"column": "t", "unit": unit, "scale": 1.0, "offset": 0.0}
    with pytest.raises(NoCodeError, match=r"damaged: .* and print"):
        program_of({**stored, "thermometer": warm})


@pytest.mark.parametrize(
    "value", ["1.0", None, True, 10**9, 2**70, [1.0, "2"], [[1.0], [2.0, 3.0]]]
)
def test_a_constant_that_is_no_number_or_a_loop_without_end_is_refused(
    camera: Calibration, value: Any
) -> None:
    stored = stored_program(flight_code(SENSORS["six faces"].calibrated(camera)).program)
    stored["steps"][-1]["constants"]["steps"] = value
    with pytest.raises(NoCodeError, match="damaged"):
        program_of(stored)


@pytest.mark.parametrize("at", [0, -1])
def test_constants_that_do_not_fit_each_other_make_no_code(camera: Calibration, at: int) -> None:
    """Lost, or one of their rows: they are told, not run into."""
    saved = corrected("six faces", camera)
    _, read = poses("six faces", saved, 6)
    for name in saved.document["flight"]["steps"][at]["constants"]:
        held = json.loads(json.dumps(saved.document))
        made = held["flight"]["steps"][at]["constants"]
        made[name] = made[name][:-1] if isinstance(made[name], list) else [1.0, 2.0]
        with suppress(NoCodeError):  # one that Python does not read
            corrected_code(replace(saved, document=held), read).files("s", {}, "")
        del made[name]
        with suppress(NoCodeError):
            corrected_code(replace(saved, document=held), read).files("s", {}, "")


def test_a_correction_of_a_correction_is_in_the_code(camera: Calibration, tmp_path: Path) -> None:
    once = corrected("electrodes", camera)
    back = tuple(tuple(float(c) for c in row) for row in TURN.T)
    change = Correction(("boresight",), (1.0,) * 4, (0.0,) * 4, back, ERRORS, ERRORS, (), 12)
    path = tmp_path / "twice.json"
    path.write_text(json.dumps(with_correction(once, change, [])))
    twice = load(path)
    rows, read = poses("electrodes", twice, 6)
    said = module_of(written(corrected_code(twice, read), tmp_path)).sun(rows)
    expected = twice.predict(read.features, read.context)
    good = np.isfinite(said[:, 0]) & np.isfinite(expected[:, 0])
    assert good.mean() > 0.5
    assert np.max(apart_deg(said[good], expected[good])) < 0.01 * twice.stated_deg
    assert np.median(apart_deg(said[good], once.predict(read.features)[good])) > 3.0
