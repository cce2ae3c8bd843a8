"""Files of a correction: all that a calibration writes, and a report of the poses."""

from __future__ import annotations

import datetime as dt
import hashlib
import json
from pathlib import Path

import bench
import numpy as np
import pytest

from calibrate.calibration import Calibration
from calibrate.documents import document, of_document
from calibrate.flight.code import flight_code
from calibrate.products import corrected_products
from calibrate.readings import Readings
from calibrate.recalibration import Correction, Errors, poses_of
from calibrate.report.page import correction_report, outcomes_of
from calibrate.report.requirement import requirement

STILL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
ANGLES = np.random.default_rng(5).uniform(-40, 40, (12, 2))


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of twelve poses by a camera whose spots moved."""
    spots = bench.spots(bench.sun_of(ANGLES), 2) + np.array([3.0, -4.0])
    path = tmp_path_factory.mktemp("few") / "few <poses>.csv"
    return Path(bench.write(path, bench.HEADER, spots, ANGLES))


def moved(errors_deg: np.ndarray) -> Correction:
    before, after = Errors(0.8, 0.7, 0.9, 0.8), Errors.of(errors_deg)
    return Correction(
        ("offset",), (1.0, 1.0), (3.0, -4.0), STILL, before, after, ("x_px moved by 3 +- 0.01",),
        12, int(np.isnan(errors_deg).sum()), 0.012, errors_deg,
    )  # fmt: skip


@pytest.fixture(scope="module")
def poses(camera: Calibration, few: Path) -> Readings:
    return poses_of([few], of_document(document(camera), "camera"))


def test_all_files_are_there_and_name_the_new_document(camera: Calibration, few: Path) -> None:
    old = of_document(document(camera, "", flight_code(camera).program), "camera")
    told: list[str] = []
    asked = [requirement("0.1deg@rms")]
    made, outcomes = corrected_products(
        old, moved(np.full(12, 0.01)), [few], "cam", "sunatlas calibrate", asked, tell=told.append
    )
    ends = (".json", ".py", ".h", ".c", "_selftest.c", "_example.c", "_report.html", ".sha256")
    assert sorted(made) == sorted(f"cam{end}" for end in ends)
    assert told[0].endswith("on 12 of the new poses")
    held = json.loads(made["cam.json"])
    assert held["digest"] != old.document["digest"]
    assert held["digest"][:32] in made["cam.c"]
    listed = dict(reversed(line.split("  ")) for line in made["cam.sha256"].splitlines())
    assert listed.pop("cam.c") == hashlib.sha256(made["cam.c"].encode()).hexdigest()
    assert len(listed) == 6
    (judged,) = outcomes
    assert (judged.word, judged.found_deg) == ("met", pytest.approx(0.01))


def test_the_report_says_errors_of_poses_and_how_it_was_made(poses: Readings) -> None:
    errors = np.linspace(0.001, 0.012, 12)
    errors[4] = np.nan
    found = moved(errors)
    asked = [requirement("0.1deg@rms"), requirement("0.1deg@3sigma")]
    outcomes = outcomes_of(found, poses, asked)
    # a pose without an answer counts as one above the limit
    assert [one.word for one in outcomes] == ["not met", "not shown"]
    said = {"Files": "few <poses>.csv", "Command": ""}
    text = correction_report(found, poses, outcomes, said, dt.date(2030, 1, 2))
    assert "Report of 2030-01-02" in text
    assert "few &lt;poses&gt;.csv" in text
    assert "<poses>" not in text
    assert "Requirement 0.1deg@3sigma: not shown." in text
    assert "Command" not in text
    rows = text.split("<h2>Poses")[1].split("<h2>")[0].split("<tr>")[2:]
    assert "no answer" in rows[0]
    assert ">6<" in rows[0]  # the fifth pose: the header is row 1
    assert "0.012" in rows[1]
    assert len(rows) == 12
