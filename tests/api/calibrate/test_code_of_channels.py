"""Flight code of many channels: C and Python answer what the table does, and flag the rest."""

from __future__ import annotations

import shutil
import subprocess
import sys

import bench
import mistakes
import numpy as np
import pytest

from algorithms.angles import separation_deg
from api.calibrate.calibration import calibrate
from api.calibrate.flight.channels import channel_table
from api.calibrate.products import write_products

FLAGS = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A calibration of a box of cells, and its files."""
    directory = tmp_path_factory.mktemp("box")
    found = calibrate(mistakes.on_sphere(directory / "box.csv", 0).paths, models=("trig", "basic"))
    write_products(found, directory / "out", "box")
    return found, directory / "out"


def run(directory, *command, **known):
    return subprocess.run(
        command, cwd=directory, check=True, capture_output=True, text=True, **known
    ).stdout


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler here")
@pytest.mark.parametrize(
    "more",
    [["-O2", "-fsanitize=undefined,address"], pytest.param(["-O2"], marks=pytest.mark.slow)],
)
def test_c_agrees_with_its_vectors_and_with_python(more, made):
    found, out = made
    build = ["gcc", *FLAGS, *more, "box.c", "box_table.c"]
    run(out, *build, "box_selftest.c", "-o", "selftest", "-lm")
    said = run(out, "./selftest")
    assert said.startswith("72 vectors, 0 flags wrong")
    run(out, *build, "box_example.c", "-o", "example", "-lm")
    sun = bench.sphere(500, 3)
    signals = bench.faces(sun, 4)
    signals[-3:] = [[0.0] * 6, [np.nan, 0, 0, 0, 0, 1], [1, 1, 1, 1, 1, 1]]
    lines = "\n".join(" ".join(f"{v:.9g}" for v in row) for row in signals)
    lines_out = run(out, "./example", input=lines).splitlines()
    assert lines_out[-3:] == ["outside"] * 3
    code = [[np.nan] * 3 if "outside" in line else line.split() for line in lines_out]
    answered = np.array(code, dtype=float)
    expected = channel_table(
        found.model, found.readings.features, {}, found.chosen.rms_deg
    ).predict(signals)
    same = np.isfinite(answered).all(axis=1) == np.isfinite(expected).all(axis=1)
    assert same.mean() > 0.995  # one that lies on the limit may fall either way
    both = np.isfinite(answered).all(axis=1) & np.isfinite(expected).all(axis=1)
    assert both.mean() > 0.98
    assert np.max(separation_deg(answered[both], expected[both])) < 1e-4
    off = separation_deg(answered[both], sun[both])
    assert np.sqrt(np.mean(off**2)) < 1.2 * found.chosen.rms_deg


def test_python_without_the_package_answers_what_the_table_does(made):
    _, out = made
    run(out, sys.executable, "-m", "py_compile", "box.py")
    names: dict = {}
    exec((out / "box.py").read_text(), names)
    signals = bench.faces(bench.sphere(100, 5), 6)
    answered = names["sun"](signals)
    assert np.isfinite(answered).all(axis=1).mean() > 0.97
    assert np.isnan(names["sun"]([[np.nan] * 6, [0.0] * 6])).all()


@pytest.mark.skipif(shutil.which("cppcheck") is None, reason="no cppcheck here")
def test_the_code_that_flies_has_no_misra_finding(made):
    _, out = made
    lines_out = subprocess.run(
        ["cppcheck", "--addon=misra", "--quiet", "--std=c99", "box.c", "box_table.c"],
        cwd=out, check=True, capture_output=True, text=True,
    )  # fmt: skip
    assert lines_out.stderr == ""
