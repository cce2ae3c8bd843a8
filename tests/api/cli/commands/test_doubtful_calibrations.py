"""A calibration that is not good ends with 3, so that a script does not take it for one."""

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
from typer.testing import CliRunner

from api.cli.command_line import app


def test_a_calibration_that_is_not_good_is_written_and_ends_with_3(tmp_path: Path) -> None:
    draw = np.random.default_rng(1)
    angles_deg = draw.uniform(-30.0, 30.0, (14, 2))  # alpha beside x, which is beta's axis
    spots_px = 512.0 + 900.0 * np.tan(np.radians(angles_deg)) + draw.normal(0.0, 0.05, (14, 2))
    rows = np.column_stack([spots_px, angles_deg])
    header = "x_px,y_px,alpha_deg,beta_deg"
    np.savetxt(tmp_path / "few.csv", rows, delimiter=",", header=header, comments="")
    certificate = tmp_path / "of few.xml"
    call = ["calibrate", str(tmp_path / "few.csv"), "--out", str(tmp_path / "out")]
    shown = CliRunner().invoke(app, [*call, "--certificate", str(certificate)])
    assert shown.exit_code == 3, shown.stderr
    assert shown.stdout.startswith("verdict: conventions uncertain - ")
    assert (tmp_path / "out" / "sun_sensor.json").is_file()
    assert ET.parse(certificate).getroot().tag.endswith("digitalCalibrationCertificate")
