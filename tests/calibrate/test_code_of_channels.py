"""Files of a calibrated box of cells: the model's own numbers in C and Python, from raw rows."""

from __future__ import annotations

import runpy
import shutil
import subprocess

import bench
import numpy as np
import pytest

from algorithms.angles import separation_deg
from calibrate.calibration import calibrate
from calibrate.documents import load
from calibrate.products import write_products

FLAGS = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-pedantic"]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A calibration of a box of cells, and its files."""
    directory = tmp_path_factory.mktemp("box")
    sun = bench.sphere(600, 500)
    names = ["xp", "xm", "yp", "ym", "zp", "zm", "sun_x", "sun_y", "sun_z"]
    path = bench.write(directory / "box.csv", names, bench.faces(sun, 0), sun)
    found = calibrate([path], models=("trig", "basic"))
    write_products(found, directory / "out", "box")
    return found, directory / "out"


def run(directory, *command, **known):
    return subprocess.run(
        command, cwd=directory, check=True, capture_output=True, text=True, **known
    ).stdout


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler here")
def test_c_answers_what_the_saved_model_does(made):
    found, out = made
    build = ["gcc", *FLAGS, "-O2", "box.c"]
    run(out, *build, "-DBOX_SELFTEST", "box_selftest.c", "-o", "selftest", "-lm")
    assert run(out, "./selftest").startswith("24 readings, 0 differ from the model")
    run(out, *build, "box_example.c", "-o", "example", "-lm")
    sun = bench.sphere(500, 3)
    signals = bench.faces(sun, 4)
    lines = "\n".join(" ".join(f"{v:.17g}" for v in row) for row in signals)
    answered = np.array([line.split() for line in run(out, "./example", input=lines).splitlines()])
    answered = answered.astype(float)
    exact = load(out / "box.json").predict(signals)
    assert np.array_equal(answered[:, 0] == 0, np.isfinite(exact[:, 0]))
    good = answered[:, 0] == 0
    assert np.max(separation_deg(answered[good, 1:4], exact[good])) < 1e-9
    assert np.allclose(answered[good, 6:8], found.intervals.at(exact[good]), rtol=1e-5)


def test_all_files_of_a_run_name_its_document(made):
    _, out = made
    digest = load(out / "box.json").document["digest"]
    code = [path for path in out.iterdir() if path.suffix in {".c", ".h", ".py"}]
    assert len(code) == 5
    assert all(digest[:16] in path.read_text() for path in code)
    assert runpy.run_path(str(out / "box.py"))["DIGEST"] == digest
