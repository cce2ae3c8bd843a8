"""A sweep along one axis calibrates the one angle, and says that it is no more than that."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from bench import CENTRE, HEADER, angles_of, spots, sun_of, turn, write

from algorithms.contract import UnusableDataError
from calibrate.calibration import calibrate
from calibrate.documents import load
from calibrate.one_axis import AxisCurve, angles_in, plane_of
from calibrate.products import write_products

CASES = Path(os.environ.get("SUNATLAS_CASES", Path(__file__).parents[4] / "shared" / "cases"))
LINE = np.linspace(-50.0, 50.0, 81)


def sweep(path: Path, sun: np.ndarray, seed: int = 1) -> Path:
    return write(path, HEADER, spots(sun, seed), angles_of(sun))


def swept(turned: float, line: np.ndarray = LINE) -> np.ndarray:
    return np.asarray(sun_of(np.column_stack([line, 0 * line])) @ turn("z", turned).T)


@pytest.mark.parametrize("turned", [0.0, 30.0, 90.0])
def test_a_sweep_is_calibrated_to_the_noise_whatever_its_plane(
    turned: float, tmp_path: Path
) -> None:
    found = calibrate([sweep(tmp_path / "one.csv", swept(turned))])
    assert found.verdict.word == "good"
    assert found.verdict.reason.startswith("one-axis calibration")
    assert any(note.startswith("one-axis calibration") for note in found.notes)
    # 0.05 px at 350 px of focal length, foreshortened away from the middle
    assert 0.003 < found.chosen.rms_deg < 0.0082
    # poses between those of the sweep, and other noise
    fresh = swept(turned, np.random.default_rng(5).uniform(-49.0, 49.0, 1000))
    predicted = found.model.predict(spots(fresh, 7))
    start, across = plane_of(found.readings.sun)
    error = angles_in(predicted, start, across) - angles_in(fresh, start, across)
    sigma = found.deviation_deg(spots(fresh, 7))
    assert np.sqrt(np.mean(error**2)) < 0.0095
    assert 0.92 <= np.mean(np.abs(error) <= 1.96 * sigma) <= 0.985


def test_wrong_poses_of_a_sweep_are_left_out_and_named(tmp_path: Path) -> None:
    wrong = [12, 60]
    line = LINE.copy()
    line[wrong] += [4.0, -7.0]
    path = write(tmp_path / "one.csv", HEADER, spots(swept(0.0), 1), angles_of(swept(0.0, line)))
    found = calibrate([path])
    assert [one.row - 2 for one in found.excluded] == wrong
    assert found.chosen.rms_deg < 0.0082
    assert found.verdict.word == "model misfit"  # more than 2 of 100 poses


def test_beyond_the_sweep_nothing_is_answered() -> None:
    model = AxisCurve().fit(spots(swept(0.0), 1), swept(0.0))
    beyond = [[CENTRE, CENTRE + 2000.0], [CENTRE, CENTRE], [np.nan, CENTRE]]
    assert np.isfinite(model.predict(beyond)[:, 0]).tolist() == [False, True, False]


def test_a_sweep_of_channels_asks_for_a_second_axis(tmp_path: Path) -> None:
    sun = swept(0.0)
    cells = np.column_stack([sun @ [c, 0.3, 1.0] for c in (-0.5, -0.2, 0.1, 0.2, 0.5)])
    names = [*(f"pd{n}" for n in range(5)), "sun_x", "sun_y", "sun_z"]
    with pytest.raises(UnusableDataError, match="second axis would settle"):
        calibrate([write(tmp_path / "cells.csv", names, cells, sun)])


@pytest.mark.skipif(not CASES.is_dir(), reason="no ../shared beside this checkout")
@pytest.mark.parametrize(
    ("name", "most_deg"), [("form-38_one_axis.csv", 0.01), ("one-axis-sweep.csv", 0.16)]
)
def test_files_of_one_axis_end_with_a_report_and_a_document(
    name: str, most_deg: float, tmp_path: Path
) -> None:
    found = calibrate([CASES / name])
    assert "one-axis calibration" in found.verdict.reason
    assert found.chosen.rms_deg < most_deg
    written = {path.name for path in write_products(found, tmp_path, "axis")}
    assert written == {
        *("axis.json", "axis_report.html", "axis_no_code.txt", "axis.sha256"),
    }
    stated = json.loads((tmp_path / "axis.json").read_text())
    assert stated["model"]["name"] == "polynomial-one-axis"
    assert "one-axis calibration" in stated["verdict"]["reason"]
    again, features = load(tmp_path / "axis.json"), found.readings.features
    assert np.array_equal(again.predict(features), found.model.predict(features), equal_nan=True)
    assert np.isfinite(again.predict(features)[:, 0]).mean() > 0.95
