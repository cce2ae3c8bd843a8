"""Scores measured again from a bundle: from its samples alone, to the last digit."""

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from api.deposit import rescoring
from benchmark.contract import Cell
from benchmark.datasets.export_arrays import read_archive, write_archive
from benchmark.datasets.preset import Preset

pytestmark = pytest.mark.slow
NAMED = [
    Cell("pd-slit", "nominal", "voltage-balance", "polynomial-1d"),
    Cell("cmos-single-aperture", "nominal", "bcm", "polynomial-2d"),
]


@pytest.fixture
def nothing_is_simulated(monkeypatch):
    """Whoever asks a data set for light, readings or bounds fails."""

    def refuse(*_arguments, **_more):
        raise AssertionError("simulated")

    for name in ("generate", "bound", "references", "scene"):
        monkeypatch.setattr(Preset, name, refuse)


def scores(bundle):
    return rescoring.read_scores(bundle)


@pytest.mark.usefixtures("nothing_is_simulated")
def test_a_score_of_the_samples_is_the_stated_one_to_the_last_digit(built):
    stated = scores(built.directory)
    cells = [*NAMED, *rescoring.draw(rescoring.repeatable(built.directory, stated), 4, 7)]
    found = list(rescoring.rescore(built.directory, sorted(set(cells))))
    assert [(one.cell, one.differing) for one in found] == [(c, []) for c in sorted(set(cells))]
    assert all(one.found["rms_deg"] > 0 for one in found if one.cell in NAMED)


@pytest.mark.usefixtures("nothing_is_simulated")
def test_a_changed_sample_and_a_changed_digit_are_found(bundle):
    path = bundle / rescoring.SCORES
    cell, other = NAMED
    stated = scores(bundle)[other]["rms_deg"]
    last = f"{stated[:-1]}{(int(stated[-1]) + 1) % 10}"
    text = path.read_text("utf-8")
    (line,) = re.findall(
        rf"^cmos-single-aperture,\d+,nominal,0,.*,bcm,.*,{other.model},.*$", text, re.MULTILINE
    )
    path.write_text(text.replace(line, line.replace(f",{stated},", f",{last},", 1)), "utf-8")
    folder = bundle / "frames" / cell.dataset / "nominal"
    arrays = read_archive(folder / "test.npz")
    arrays["observations"][0] += 1e-3 * np.abs(arrays["observations"][0])[::-1]
    write_archive(folder / "test.npz", arrays)
    of_sample, of_digit = rescoring.rescore(bundle, NAMED)
    assert "rms_deg" in of_sample.differing
    assert "repeatability_deg" not in of_sample.differing
    assert of_digit.differing == ["rms_deg"]


def test_the_bundle_alone_is_enough(built, tmp_path):
    """In an empty directory and environment: Python, and the registry that pip is configured with.

    Takes minutes: packages are installed and loops compiled.
    """
    with zipfile.ZipFile(built.archive) as packed:
        packed.extractall(tmp_path)
    (place,) = tmp_path.iterdir()
    (tmp_path / "home").mkdir()
    kept = {"PATH": os.environ["PATH"], "HOME": str(tmp_path / "home")}
    kept |= {name: value for name, value in os.environ.items() if name.startswith("PIP_")}
    shown = subprocess.run(
        [Path(sys._base_executable), "rescore.py", "--cells", "3", "--seed", "2"],
        cwd=place,
        env=kept,
        capture_output=True,
        text=True,
        check=False,
        timeout=1800,
    )
    assert shown.returncode == 0, shown.stderr
    assert "3 of 3 scores are the same to the last digit" in shown.stderr
