"""Small files that once were called good, or mended wrongly, and how each ends."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from algorithms.angles import separation_deg
from algorithms.contract import UnusableDataError
from calibrate.calibration import calibrate
from calibrate.readings import features_of
from calibrate.settings import read_settings

CASES = Path(__file__).parents[4] / "shared" / "cases"

pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason="no ../shared beside this checkout")
MAPS = ("spm", "lsq", "polynomial-2d", "lut-polynomial")
CELLS = ("polynomial-signals", "assembled-faces")


@pytest.mark.parametrize("late", [2, pytest.param(0, marks=pytest.mark.slow)])
def test_sentinels_are_named_and_rows_that_are_late_are_found_once(late, tmp_path):
    lines = (CASES / "sentinel-999.csv").read_text().split()
    cells = np.array([line.split(",") for line in lines[1:]])
    cells[:, :2] = np.roll(cells[:, :2], late, axis=0)
    path = tmp_path / "late.csv"
    path.write_text("\n".join([lines[0], *(",".join(row) for row in cells)]) + "\n")
    found = calibrate([path], models=("homography", "lsq"), apply=True)
    sentinels = int((cells[:, 0] == "-999.00000").sum())
    reasons = Counter(one.reason for one in found.excluded)
    assert reasons["sentinel -999 in x_px"] == sentinels
    assert [one.change for one in found.applied] == ([{"rows": {"shift": late}}] if late else [])
    assert found.settings.rows.shift == late
    assert found.chosen.rms_deg == pytest.approx(0.0085, abs=0.0005)
    assert found.verdict.word == "good"
    assert found.limits.low == (-999.0, -999.0)
    again = calibrate([path], found.settings, models=("homography", "lsq"), apply=True)
    assert again.applied == ()
    assert again.settings == found.settings


@pytest.mark.slow
def test_quadrants_that_fall_from_five_volts_are_good_only_with_dark_and_inversion():
    path = CASES / "quadrants-inverted-5V.csv"
    as_stated = calibrate([path], models=MAPS)
    assert as_stated.verdict.word == "conventions uncertain"
    found = calibrate([path], models=MAPS, apply=True)
    assert found.verdict.word == "good"
    assert found.settings.readings.inverted
    assert found.settings.readings.dark == pytest.approx([5.0] * 4, abs=0.002)
    raw = np.loadtxt(path, delimiter=",", skiprows=1)[:, :4]
    answers = [
        found.model.predict(features_of(5.0 - light * (5.0 - raw), found.settings))
        for light in (1.0, 0.9)
    ]
    moved = separation_deg(*answers)
    known = np.isfinite(moved)
    assert known.mean() > 0.9
    assert np.sqrt(np.mean(moved[known] ** 2)) < 0.1 * found.chosen.rms_deg
    again = calibrate([path], found.settings, models=MAPS, apply=True)
    assert again.applied == ()


@pytest.mark.parametrize("config", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_plain_cells_are_channels_that_are_neither_inverted_nor_mirrored(config):
    settings = read_settings(CASES / "four-tilted-photodiodes.toml") if config else None
    path = CASES / "four-tilted-photodiodes.csv"
    found = calibrate([path], settings, models=CELLS, apply=True)
    assert found.settings.readings.kind == "channels"
    assert found.applied == ()
    assert [one for one in found.findings if one.certain] == []
    assert found.verdict.word == "good"
    signals = found.readings.features
    moved = separation_deg(found.model.predict(signals), found.model.predict(0.9 * signals))
    assert np.nanmax(moved) < 0.1 * found.chosen.rms_deg


def test_six_faces_before_one_dims_are_good():
    found = calibrate([CASES / "cell-dimmed-before.csv"], models=("basic", "assembled-faces"))
    assert found.verdict.word == "good"
    assert found.chosen.rms_deg < 0.2


def test_readings_by_chance_are_refused_in_one_sentence():
    with pytest.raises(UnusableDataError, match="do not belong together") as refused:
        calibrate([CASES / "faces-random.csv"])
    assert len(str(refused.value)) < 200
