"""An old calibration is corrected by a few poses: a turn, an offset, or nothing."""

from __future__ import annotations

import json

import bench
import numpy as np
import pytest
import typer

from algorithms.angles import separation_deg
from algorithms.contract import UnusableDataError
from api.cli.commands.calibrate import app
from calibrate.calibration import calibrate
from calibrate.documents import load, save
from calibrate.recalibration import recalibrate

FEW = np.random.default_rng(5).uniform(-40, 40, (12, 2))
SUN = bench.sun_of(FEW)
FRESH = bench.sun_of(np.random.default_rng(6).uniform(-45, 45, (500, 2)))


@pytest.fixture(scope="module")
def old(camera, tmp_path_factory):
    """Path of a camera's calibration."""
    path = tmp_path_factory.mktemp("old") / "old.json"
    save(camera, path)
    return path


def few(path, spots, stated=SUN):
    return bench.write(path, bench.HEADER, spots, bench.angles_of(stated))


@pytest.mark.slow
def test_a_turned_sensor_is_corrected_by_twelve_poses_one_of_them_wrong(old, tmp_path):
    turn = bench.turn("x", 0.7) @ bench.turn("z", 0.4)
    stated = SUN @ turn.T
    stated[3] = bench.sun_of(np.array([[0.0, 10.0]]))[0]
    path = few(tmp_path / "few.csv", bench.spots(SUN, 2), stated)
    found = recalibrate([path], load(old))
    assert found.kinds == ("boresight",)
    angle = np.degrees(np.arccos((np.trace(np.asarray(found.rotation)) - 1.0) / 2.0))
    assert angle == pytest.approx(np.hypot(0.7, 0.4), abs=0.03)
    out = tmp_path / "out"
    command = typer.main.get_command(app)
    status = command.main(
        [str(path), "--onto", str(old), "--out", str(out), "--name", "later"], standalone_mode=False
    )
    assert status == 0
    answered = load(out / "later.json").predict(bench.spots(FRESH, 3))
    assert np.nanmean(separation_deg(answered, FRESH @ turn.T)) < 0.02
    # and once more, back again
    back = few(tmp_path / "back.csv", bench.spots(SUN, 4))
    command.main(
        [str(back), "--onto", str(out / "later.json"), "--out", str(out), "--name", "back"],
        standalone_mode=False,
    )
    answered = load(out / "back.json").predict(bench.spots(FRESH, 5))
    assert np.nanmean(separation_deg(answered, FRESH)) < 0.02


def test_a_sensor_as_it_was_stays_as_it_is(old, tmp_path):
    found = recalibrate([few(tmp_path / "few.csv", bench.spots(SUN, 2))], load(old))
    assert found.kinds == ()
    assert found.explained
    assert found.rotation == ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def test_poses_outside_the_old_field_are_refused(old, tmp_path):
    path = few(tmp_path / "few.csv", np.full((12, 2), 5.0))
    with pytest.raises(UnusableDataError, match="answers 0 of the 12 poses"):
        recalibrate([path], load(old))


def test_a_temperature_beyond_those_measured_is_not_answered(tmp_path):
    rng = np.random.default_rng(1)
    sun = bench.sphere(400, 2)
    kelvin = rng.uniform(270.0, 320.0, 400)
    signals = bench.faces(sun, 3) * (1.0 + 0.002 * (kelvin - 295.0))[:, None]
    names = ["xp", "xm", "yp", "ym", "zp", "zm", "sun_x", "sun_y", "sun_z", "temperature_K"]
    path = bench.write(tmp_path / "a.csv", names, signals, sun, kelvin)
    found = calibrate([path], models=("temperature + basic",))
    save(found, tmp_path / "a.json")
    loaded = load(tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text())["fit"]["temperature_K"][0] < 271.0
    three = {"temperature_K": np.array([290.0, 250.0, 340.0])}
    answered = np.isfinite(loaded.predict(signals[:3], three)).all(axis=1)
    assert answered.tolist() == [True, False, False]
