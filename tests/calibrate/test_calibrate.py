"""From a file to a calibration: wrong poses, runs, folds, refusals, intervals, code."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bench import CENTRE, HEADER, angles_of, grid, quadrants, spots, sun_of, turn, write

from algorithms.angles import separation_deg
from algorithms.contract import UnusableDataError
from api.cli.commands.calibrate import app
from calibrate.calibration import calibrate
from calibrate.documents import load, save
from calibrate.products import write_products
from calibrate.table import TableError, read_table

SHARED = Path(__file__).parents[3] / "shared"
MODELS = ("homography", "pinhole", "polynomial-2d")
ANGLES = grid(15)
SUN = sun_of(ANGLES)


def bench_file(path: Path, angles=ANGLES, seed: int = 1) -> Path:
    return write(path, HEADER, spots(sun_of(angles), seed), angles)


@pytest.fixture(scope="module")
def written(camera, tmp_path_factory):
    """Directory of its files."""
    directory = tmp_path_factory.mktemp("written")
    write_products(camera, directory, "cam")
    return directory


def test_the_model_that_made_the_file_is_chosen_and_nothing_left_out(camera):
    assert camera.chosen.name == "homography"
    assert camera.verdict.word == "good"
    assert camera.excluded == ()
    assert camera.findings == ()
    # 0.05 px an axis at 350 px of focal length, foreshortened away from the middle
    assert 0.005 < camera.chosen.rms_deg < 0.0116


def test_95_percent_intervals_hold_on_poses_and_noise_nobody_saw(camera):
    fresh = sun_of(np.random.default_rng(9).uniform(-45, 45, (4000, 2)))
    features = spots(fresh, 77)
    sigma = camera.deviation_deg(features)
    predicted = camera.model.predict(features)
    first = np.cross(fresh, [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first, axis=1)[:, None]
    along = np.degrees(np.abs(((predicted - fresh) * first).sum(axis=1)))
    assert 0.93 <= np.mean(along <= 1.96 * sigma) <= 0.97


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


@pytest.mark.slow
def test_a_run_off_by_a_constant_is_left_out(tmp_path):
    files = []
    for number in range(4):
        angles = grid(13)
        sun = sun_of(angles)
        stated = angles_of(sun @ turn("x", 3.0).T) if number == 2 else angles
        path = tmp_path / f"run{number}.csv"
        files.append(write(path, HEADER, spots(sun, 10 + number), stated))
    found = calibrate(files, models=("homography",))
    assert [(one.run, round(one.offset_deg, 1)) for one in found.off_runs] == [(2, 3.0)]
    assert found.chosen.rms_deg < 0.0116


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


def test_python_without_the_package_answers_what_the_model_does(camera, written):
    said = (
        "import cam, json\n"
        "print(json.dumps(cam.sun([[512.0, 512.0], [700.5, 300.25], [5.0, 5.0]]).tolist()))"
    )
    run = subprocess.run(
        [sys.executable, "-I", "-c", f"import sys; sys.path.insert(0, {str(written)!r})\n{said}"],
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    answered = np.array(json.loads(run.stdout.replace("NaN", "null")), dtype=float)
    exact = camera.model.predict([[512.0, 512.0], [700.5, 300.25], [5.0, 5.0]])
    assert np.isnan(answered[2]).all()
    assert np.isnan(exact[2]).all()
    assert np.max(separation_deg(answered[:2], exact[:2])) < 1e-3


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler here")
def test_the_c_code_passes_its_own_test_without_a_warning(camera, written):
    flags = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-O2", "-fsanitize=undefined,address"]
    command = ["gcc", "-std=c99", *flags]
    files = ["-DCAM_SELFTEST", "cam.c", "cam_selftest.c", "-o", "selftest", "-lm"]
    subprocess.run([*command, *files], cwd=written, check=True)
    run = subprocess.run(["./selftest"], cwd=written, check=False, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout
    example = ["cam.c", "cam_example.c", "-o", "example", "-lm"]
    subprocess.run([*command, *example], cwd=written, check=True)
    output = subprocess.run(
        ["./example"], cwd=written, check=True, capture_output=True, text=True,
        input="512 512\n700.5 300.25\n5 5\n1e30 nan\n",
    ).stdout.splitlines()  # fmt: skip
    directions = np.array([line.split()[1:4] for line in output[:2]], dtype=float)
    exact = camera.model.predict([[512.0, 512.0], [700.5, 300.25]])
    assert np.max(separation_deg(directions, exact)) < 1e-3
    assert [line.split()[0] for line in output] == ["0", "0", "6", "1"]


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
