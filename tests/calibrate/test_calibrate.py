"""From a file to a calibration: wrong poses, runs, folds, refusals, intervals, code."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bench import CENTRE, HEADER, angles_of, grid, quadrants, spots, sun_of, write

from algorithms.angles import separation_deg
from algorithms.contract import UnusableDataError
from api.cli.commands.calibrate import app
from calibrate.calibration import calibrate
from calibrate.documents import load, save
from calibrate.table import TableError, read_table

SHARED = Path(__file__).parents[3] / "shared"
MODELS = ("homography", "pinhole", "polynomial-2d")
ANGLES = grid(15)
SUN = sun_of(ANGLES)


def bench_file(path: Path, angles=ANGLES, seed: int = 1) -> Path:
    return write(path, HEADER, spots(sun_of(angles), seed), angles)


def test_the_model_that_made_the_file_is_chosen_and_nothing_left_out(camera):
    assert camera.chosen.name == "homography"
    assert camera.verdict.word == "good"
    assert camera.excluded == ()
    assert camera.findings == ()
    # 0.05 px an axis at 350 px of focal length, foreshortened away from the middle
    assert 0.005 < camera.chosen.rms_deg < 0.0116


def test_wrong_poses_are_listed_and_cost_nothing(camera, tmp_path):
    rng = np.random.default_rng(3)
    angles = ANGLES.copy()
    bad = rng.choice(len(angles), len(angles) // 10, replace=False)
    axes = np.cross(SUN[bad], rng.normal(size=(len(bad), 3)))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    off = np.radians(rng.uniform(1.0, 30.0, len(bad)))[:, None]
    angles[bad] = angles_of(np.cos(off) * SUN[bad] + np.sin(off) * axes)
    found = calibrate([write(tmp_path / "b.csv", HEADER, spots(SUN, 1), angles)], models=MODELS)
    listed = {one.row - 2 for one in found.excluded if one.reason == "wrong pose"}
    assert listed >= set(bad)
    assert len(listed - set(bad)) <= 4
    clean = separation_deg(found.model.predict(spots(SUN, 5)), SUN)
    before = separation_deg(camera.model.predict(spots(SUN, 5)), SUN)
    both = np.isfinite(clean) & np.isfinite(before)
    assert np.sqrt(np.mean(clean[both] ** 2)) <= 1.05 * np.sqrt(np.mean(before[both] ** 2))


def test_what_lies_beyond_a_fold_is_left_out(tmp_path):
    angles = grid(35, 60.0)
    header = ["q1", "q2", "q3", "q4", "theta_x_deg", "theta_y_deg"]
    path = write(tmp_path / "q.csv", header, quadrants(sun_of(angles), 3), angles)
    found = calibrate([path], models=("spm", "lsq"))
    # the patch of light, 2 mm wide and 1.5 mm away, leaves a quadrant at 33.7 deg
    inside = np.abs(found.readings.sun[:, :2] / found.readings.sun[:, [2]]).max(axis=1)
    assert inside.max() < 0.8
    assert found.fold_deg is not None
    assert found.chosen.rms_deg < 0.3


def test_a_cross_of_two_sweeps_misses_poses(tmp_path):
    line = np.linspace(-50.0, 50.0, 80)
    angles = np.vstack([np.column_stack([line, 0 * line]), np.column_stack([0 * line, line])])
    found = calibrate([bench_file(tmp_path / "cross.csv", angles)], models=MODELS)
    assert found.verdict.word == "poses missing"
    assert found.fold_deg is None


def test_no_model_calls_a_mirrored_file_good_without_leave_to_mirror(tmp_path):
    mirrored = (spots(SUN, 1) - CENTRE) * [-1, 1] + CENTRE
    path = write(tmp_path / "mirrored.csv", HEADER, mirrored, ANGLES)
    found = calibrate([path], models=("homography",))
    assert found.verdict.word == "conventions uncertain"
    assert "mirror-x" in found.verdict.reason
    again = calibrate([path], models=("homography",), apply=True)
    assert again.verdict.word != "conventions uncertain"


@pytest.mark.parametrize("seed", range(2))
def test_readings_that_have_nothing_to_do_with_the_light_are_refused(seed, tmp_path):
    rng = np.random.default_rng(seed)
    path = write(tmp_path / "random.csv", HEADER, rng.uniform(0, 1000, SUN[:, :2].shape), ANGLES)
    with pytest.raises(UnusableDataError, match="do not belong together"):
        calibrate([path], models=("pinhole", "polynomial-2d"))


@pytest.mark.skipif(not SHARED.is_dir(), reason="no ../shared beside this checkout")
@pytest.mark.parametrize("runs", [3, pytest.param(7, marks=pytest.mark.slow)])
def test_the_box_errs_below_five_degrees_on_runs_left_out(runs):
    files = sorted((SHARED / "real" / "cubesatbox").glob("run*.csv"))[:runs]
    assert len(files) == runs
    found = calibrate(files, models=("polynomial-signals",), apply=True)
    assert found.chosen.rms_deg < 5.0
    assert any(one.reason == "wrong pose" for one in found.excluded)


def test_a_saved_calibration_answers_the_same_bits(camera, tmp_path):
    save(camera, tmp_path / "camera.json")
    loaded = load(tmp_path / "camera.json")
    features = spots(SUN, 8)
    assert np.array_equal(loaded.predict(features), camera.model.predict(features), equal_nan=True)
    text = (tmp_path / "camera.json").read_text()
    (tmp_path / "other.json").write_text(text.replace('"samples": 441', '"samples": 442'))
    with pytest.raises(ValueError, match="changed after it was saved"):
        load(tmp_path / "other.json")


def test_the_command_writes_report_and_code_and_a_template(tmp_path, monkeypatch, capsys):
    import typer

    path = bench_file(tmp_path / "camera.csv", grid(11))
    command = typer.main.get_command(app)
    toml = tmp_path / "sensor.toml"
    command.main([str(path), "--init", str(toml)], standalone_mode=False)
    out = tmp_path / "out"
    status = command.main(
        [str(path), "--config", str(toml), "--model", "homography", "--out", str(out)],
        standalone_mode=False,
    )
    assert status == 0
    assert "verdict: good" in capsys.readouterr().out
    page = (out / "sun_sensor_report.html").read_text()
    assert page.count("<svg") == 5
    ends = {path.suffix for path in out.iterdir()}
    assert ends == {".html", ".json", ".py", ".c", ".h", ".sha256"}


def test_an_interrupted_command_leaves_nothing(camera, tmp_path, monkeypatch):
    import typer

    from calibrate import calibration, products

    def interrupted(*_):  # the report is the last that is made
        raise KeyboardInterrupt

    monkeypatch.setattr(calibration, "calibrate", lambda *_, **__: camera)
    monkeypatch.setattr(products, "report", interrupted)
    command = typer.main.get_command(app)
    status = command.main(["a.csv", "--out", str(tmp_path / "out")], standalone_mode=False)
    assert status == 130
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "empty"),
        ("x_px,y_px\n1,2\n", "direction"),
        ("x_px,y_px,alpha,beta\n1,2,3\n", "row 2.*4.*3"),
        (
            "x_px,y_px,alpha,beta\n1,2,3,4\n1,b,3,4\n",
            "row 3.*y_px.*'b'",
        ),
        ("x_px,x_px,alpha,beta\n1,2,3,4\n", "stands twice"),
        ("1,2,3,4\n5,6,7,8\n", "expected a header"),
        ("x_px,y_px,alpha,beta\n,,,\n", "no row can be used"),
        ("x_px,y_px,alpha,beta\n=1+1,2,3,4\n", "expected a number"),
    ],
)
def test_a_file_that_is_no_table_is_refused_by_place(text, said, tmp_path):
    path = tmp_path / "bench.csv"
    path.write_text(text)
    with pytest.raises(TableError, match=said):
        calibrate([path])


@pytest.mark.parametrize("form", ["parquet", "npz", "xlsx", "semicolons"])
def test_the_same_numbers_are_read_from_every_kind_of_file(form, tmp_path):
    import pandas as pd

    features = spots(SUN[:30], 1)
    frame = pd.DataFrame(np.column_stack([features, ANGLES[:30]]), columns=HEADER)
    path = tmp_path / f"bench.{'csv' if form == 'semicolons' else form}"
    if form == "parquet":
        frame.to_parquet(path)
    elif form == "npz":
        np.savez(path, **{name: frame[name] for name in HEADER})
    elif form == "xlsx":
        frame.to_excel(path, index=False)
    else:
        frame.to_csv(path, sep=";", decimal=",", index=False)
    table = read_table(path)
    for name in HEADER:
        assert np.allclose(table.numbers(name), frame[name], rtol=1e-14)  # Excel keeps 15 digits
