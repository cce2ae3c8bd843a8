"""`sunatlas benchmark --data`: models on a reader's file, whose errors its noise says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from tests.calibrate.bench import FOCAL, HEADER, NOISE, grid, spots, sun_of, write


def test_models_have_the_error_of_the_noise_on_a_readers_file(tmp_path: Path) -> None:
    poses = grid(11, 20.0)
    file = write(tmp_path / "bench.csv", HEADER, np.column_stack([spots(sun_of(poses), 3), poses]))
    models = ("homography", "polynomial-2d")
    asked = [word for name in models for word in ("--model", name)]
    shown = CliRunner().invoke(app, ["benchmark", "--data", str(file), *asked, "--format", "json"])
    assert shown.exit_code == 0, shown.stderr
    rows = {row["model"]: row for row in json.loads(shown.stdout)}
    # a spot's noise along either axis, near the middle of a field
    noise = np.degrees(np.sqrt(2.0) * NOISE / FOCAL)
    for name in models:
        assert rows[name]["rms_deg"] == pytest.approx(noise, rel=0.25)
        assert rows[name]["reason"] == ""
