"""Errors that are larger where light grazes a face: found, held by intervals, and in the code."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import bench
import numpy as np
import pytest
from raw_sensors import SENSORS, c_answers, module_of, written

from calibrate.calibration import Calibration
from calibrate.documents import load, save
from calibrate.flight.code import flight_code
from calibrate.places import Grazing
from calibrate.uncertainty import NORMAL_95, Intervals, intervals, tangent_offsets

NORMALS = np.vstack([one := bench.turn("x", 20.0) @ bench.turn("y", 35.0), -one])
#: 1-sigma, how many times as large it is along a normal close to its plane, and how close.
SIGMA_DEG, TIMES, CLOSE_DEG = 0.1, 3.0, 2.0


def errors(sun: np.ndarray, seed: int, times: float = TIMES) -> np.ndarray:
    """Normal errors (N, 3), along a face's normal larger where light grazes the face."""
    drawn = np.random.default_rng(seed).normal(size=sun.shape) * np.radians(SIGMA_DEG)
    for normal in NORMALS[:3]:
        close = np.abs(sun @ normal) < np.sin(np.radians(CLOSE_DEG))
        drawn += (times - 1.0) * (close * (drawn @ normal))[:, None] * normal
    return np.asarray(drawn - (drawn * sun).sum(axis=1)[:, None] * sun)


def stated(seed: int, count: int = 2500, times: float = TIMES) -> Intervals:
    sun = bench.sphere(count, seed)
    found = intervals(errors(sun, seed + 1, times), sun, NORMALS)
    assert found is not None
    return found


def test_intervals_hold_close_to_the_planes_of_faces_and_beside_them() -> None:
    found, sun = stated(1), bench.sphere(200_000, 5)
    off = errors(sun, 6)
    answers = sun + off
    answers /= np.linalg.norm(answers, axis=1)[:, None]
    size = np.abs(tangent_offsets(off, sun))
    inside = size <= NORMAL_95 * found.at(answers)
    # by the answer, which is what is known in flight
    least = np.degrees(np.arcsin(np.abs(answers @ NORMALS.T).min(axis=1)))
    close, beside = least < CLOSE_DEG, least > 2.0 * CLOSE_DEG
    plain = replace(found, grazing=Grazing.none()).at(answers)
    assert (size <= NORMAL_95 * plain)[close].mean() < 0.85
    assert inside[close].mean() == pytest.approx(0.95, abs=0.02)
    assert inside[beside].mean() == pytest.approx(0.95, abs=0.01)


def test_it_grows_along_the_normal_and_not_across_it() -> None:
    found = Grazing(np.array([[0.0, 0.0, 1.0]]), float(np.sin(np.radians(2.0))), 8.0)
    angle = np.radians([0.0, 1.0, 2.5])
    sun = np.column_stack([0.0 * angle, np.cos(angle), np.sin(angle)])
    # the first axis, s cross x, is along z here; the second is x
    times = found.times(sun)
    assert times[:, 1] == pytest.approx(1.0)
    assert times[0, 0] == pytest.approx(3.0)
    assert times[1, 0] == pytest.approx(np.sqrt(1.0 + 8.0 * 0.75), rel=1e-3)
    assert times[2, 0] == 1.0


@pytest.mark.parametrize("seed", range(2))
def test_even_errors_of_faces_do_not_grow(seed: int) -> None:
    assert not len(stated(10 * seed, 1000, times=1.0).grazing.normals)


@pytest.fixture(scope="module")
def box(camera: Calibration) -> Calibration:
    """A calibration of six faces with intervals of known errors."""
    return replace(SENSORS["six faces"].calibrated(camera), intervals=stated(1))


def test_a_loaded_calibration_states_it_too(box: Calibration, tmp_path: Path) -> None:
    path = tmp_path / "box.json"
    save(box, path)
    raw = SENSORS["six faces"].raw(5)
    # along axes computed from the covariance, so to rounding
    assert load(path).deviations_deg(raw) == pytest.approx(box.deviations_deg(raw), rel=1e-9)
    held = json.loads(path.read_text())["fit"]["intervals"]["grazing"]
    assert np.shape(held["normals"]) == (6, 3)
    assert held["sine"] > 0


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler here")
def test_c_and_python_state_what_the_calibration_does(box: Calibration, tmp_path: Path) -> None:
    written(flight_code(box), tmp_path)
    raw = SENSORS["six faces"].raw(5, 4000)
    answers = c_answers(tmp_path, raw)
    good = answers[:, 0] == 0
    assert good.mean() > 0.9
    assert box.intervals is not None
    at = answers[good, 1:4]
    expected = box.intervals.at(at)
    times = box.intervals.grazing.times(at)
    assert (times > 1.5).any(axis=1).sum() > 50
    assert answers[good, 6:8] == pytest.approx(expected, rel=2e-5)
    assert module_of(tmp_path).solve(raw)["sigma_deg"][good] == pytest.approx(expected, rel=2e-5)
