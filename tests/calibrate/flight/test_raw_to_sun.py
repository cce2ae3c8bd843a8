"""C and Python take what the file had, and answer what the calibrated model does."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import raw_sensors
from raw_sensors import (
    CHECKED,
    DARK,
    FLAGS,
    OTHERS,
    SENSORS,
    apart_deg,
    c_answers,
    compiled,
    module_of,
)

from calibrate.flight.code import flight_code
from calibrate.flight.program import program_of, stored_program

DIGEST = "0123456789abcdef0123456789abcdef"
#: A hundredth of the model's error is what code may add.
SHARE = 0.01
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler here")


@pytest.fixture(scope="module")
def written(camera, tmp_path_factory) -> Callable[[str], tuple[Any, Any, Path]]:
    """Calibration, code and directory of a sensor, made once."""
    known: dict[str, tuple[Any, Any, Path]] = {}

    def of(kind: str) -> tuple[Any, Any, Path]:
        if kind not in known:
            found = SENSORS[kind].calibrated(camera)
            code = flight_code(found)
            directory = tmp_path_factory.mktemp("code")
            raw_sensors.written(code, directory, DIGEST)
            known[kind] = found, code, directory
        return known[kind]

    return of


@needs_gcc
@pytest.mark.parametrize("kind", SENSORS)
def test_c_adds_less_than_a_hundredth_of_the_error_on_raw_rows_held_out(kind, written):
    sensor, (found, _, directory) = SENSORS[kind], written(kind)
    answers = c_answers(directory, sensor.telemetry(3))
    model = sensor.answers(found.model, 3)
    answered = answers[:, 0] == 0
    known = np.isfinite(model[:, 0])
    context = sensor.context(3).get("temperature_K", np.full(len(known), 290.0))
    measured = found.readings.context.get("temperature_K", context)
    known &= (context >= measured.min()) & (context <= measured.max())
    assert (answered == known).all()
    assert answered.mean() > 0.9
    off = apart_deg(answers[answered, 1:4], model[answered])
    error = apart_deg(model, sensor.suns(3))[answered]
    assert np.sqrt(np.mean(off**2)) <= SHARE * np.sqrt(np.mean(error**2))


@needs_gcc
@pytest.mark.parametrize("kind", SENSORS)
def test_python_answers_what_c_does(kind, written):
    sensor, (_, _, directory) = SENSORS[kind], written(kind)
    rows = sensor.telemetry(4)
    rows[5] = 0.0
    rows[6, 0] = np.nan
    readings = len(sensor.columns)
    kelvin = rows[:, readings] if rows.shape[1] > readings else None
    said = module_of(directory).solve(rows[:, :readings], kelvin)
    # scanf reads nan, too
    answers = c_answers(directory, rows)
    assert np.array_equal(said["status"], answers[:, 0].astype(int))
    assert said["status"][5] == 2
    assert said["status"][6] == 1
    good = said["status"] == 0
    assert np.max(apart_deg(said["sun"][good], answers[good, 1:4])) < 1e-9
    assert np.allclose(said["angle_deg"][good], answers[good, 4:6], rtol=0, atol=1e-7)
    assert np.allclose(said["sigma_deg"][good], answers[good, 6:8], rtol=1e-4)
    assert not answers[~good, 1:].any()


@pytest.mark.parametrize("kind", SENSORS)
def test_a_program_is_read_back_as_it_was_kept(kind, written):
    """What refuses forged programs refuses none of ours."""
    _, code, _ = written(kind)
    require_kept(code.program)


@pytest.mark.parametrize("kind", SENSORS)
def test_the_modules_own_test_passes_on_rows_of_the_calibration(kind, written):
    found, code, directory = written(kind)
    assert module_of(directory).selftest() == (0, pytest.approx(0.0, abs=0.02))
    assert (code.vectors.status == 0).sum() == 20
    ends = [tuple(row) for row in np.round(SENSORS[kind].raw(1), 9)]
    assert all(tuple(row) in ends for row in np.round(code.vectors.values[:20], 9))
    model = found.model.predict(found.readings.features, found.readings.context)
    assert all((np.abs(model - sun).max(axis=1) == 0).any() for sun in code.vectors.sun[:20])


@needs_gcc
@pytest.mark.parametrize(
    "compiler",
    [
        ["gcc", *FLAGS, "-O2"],
        ["clang", *FLAGS, "-O2"],
        ["g++", "-x", "c++", "-std=c++11", *FLAGS[1:]],
        ["gcc", *FLAGS, "-DSS_FLOAT"],
        ["gcc", *FLAGS, *CHECKED],
    ],
    ids=["gcc", "clang", "g++", "float", "sanitizers"],
)
@pytest.mark.parametrize(
    "kind",
    [
        "four tilted cells",
        *(pytest.param(name, marks=pytest.mark.slow) for name in SENSORS if "tilted" not in name),
    ],
)
def test_compilers_have_nothing_to_say_and_the_self_test_passes(compiler, kind, written):
    if shutil.which(compiler[0]) is None:
        pytest.skip(f"no {compiler[0]} here")
    _, _, directory = written(kind)
    files = ["-DSS_SELFTEST", "ss.c", "ss_selftest.c", "-o", "selftest", "-lm"]
    compiled(directory, *compiler, *files)
    assert " 0 differ from the model" in compiled(directory, "./selftest")


@needs_gcc
def test_files_of_two_runs_do_not_compile_together(written, tmp_path):
    _, code, _ = written("spots")
    raw_sensors.written(code, tmp_path, DIGEST)
    (tmp_path / "ss.h").write_text(code.files("ss", {}, DIGEST[::-1])["ss.h"])
    with pytest.raises(AssertionError, match="of different calibrations: copy both from one run"):
        compiled(tmp_path, "gcc", "-std=c99", "-c", "ss.c")


@needs_gcc
def test_dark_rows_are_refused_whichever_way_readings_go(written):
    _, _, directory = written("quadrants")
    noise = np.random.default_rng(9).normal(0.0, 0.002, (50, 4))
    assert (c_answers(directory, DARK + noise)[:, 0] == 2).all()
    _, _, directory = written("six faces")
    noise = np.random.default_rng(9).normal(0.0, 0.004, (50, 6))
    assert (c_answers(directory, noise)[:, 0] == 2).all()


@needs_gcc
def test_temperatures_that_were_not_calibrated_are_refused(written):
    sensor, (_, _, directory) = SENSORS["warm faces"], written("warm faces")
    rows = sensor.telemetry(3)
    rows[:, -1] += 273.15  # kelvin
    assert (c_answers(directory, rows)[:, 0] == 5).all()


@needs_gcc
@pytest.mark.parametrize(
    ("kind", "angles"),
    [
        ("spots", lambda x, y, z: (np.arctan(y / z), np.arctan(x / z))),
        ("quadrants", lambda x, y, z: (np.arcsin(y), np.arctan2(x, z))),
        ("electrodes", lambda x, y, z: (np.arctan2(y, z), np.arcsin(x))),
        ("six faces", lambda x, y, z: (np.arctan2(y, x), np.arccos(z))),
    ],
)
def test_angles_are_those_of_the_files_form(kind, angles, written):
    _, _, directory = written(kind)
    answers = c_answers(directory, SENSORS[kind].telemetry(5))
    answers = answers[answers[:, 0] == 0]
    expected = np.degrees(np.column_stack(angles(*answers[:, 1:4].T)))
    assert np.allclose(answers[:, 4:6], expected, rtol=0, atol=1e-5)


def require_kept(program):
    """A document keeps a program as JSON and gives it back, number by number."""
    kept = stored_program(program)
    back = stored_program(program_of(json.loads(json.dumps(kept))))
    assert json.dumps(back, sort_keys=True) == json.dumps(kept, sort_keys=True)


@pytest.mark.parametrize("name", OTHERS)
def test_models_of_faces_are_emitted_themselves(name, camera, tmp_path):
    sensor = OTHERS[name]
    found = sensor.calibrated(camera)
    code = flight_code(found)
    assert not code.flagged
    require_kept(code.program)
    (tmp_path / "ss.py").write_text(code.files("ss", {}, DIGEST)["ss.py"])
    made = module_of(tmp_path).solve(sensor.raw(3), sensor.celsius(3))
    model = sensor.answers(found.model, 3)
    answered = made["status"] == 0
    off = apart_deg(made["sun"][answered], model[answered])
    assert answered.mean() > 0.5
    assert np.sqrt(np.mean(off**2)) <= SHARE * found.chosen.rms_deg
    refused = np.isfinite(model[:, 0]) & ~answered
    assert set(np.unique(made["status"][refused])) <= {2, 4, 5}
