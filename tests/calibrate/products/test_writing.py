"""The files of a calibration belong together, and those of the one before go with it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from api.cli.commands.calibrate import app
from api.cli.wrong_call import WrongCallError
from calibrate import calibration, products
from calibrate.calibration import Calibration
from calibrate.documents import text_of
from calibrate.products import write_products, write_set
from calibrate.report.page import Asked


def digests(directory: Path, name: str) -> dict[str, str]:
    lines = (directory / f"{name}.sha256").read_text("utf-8").splitlines()
    return {line.partition("  ")[2]: line.partition("  ")[0] for line in lines}


@pytest.fixture(scope="module")
def out(camera: Calibration, tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("written") / "out"
    write_products(camera, directory, "cam", asked=Asked(certificate="cam_certificate.xml"))
    return directory


def test_files_of_the_calibration_before_go_and_others_stay(tmp_path: Path) -> None:
    out = tmp_path / "out"
    write_set({"cam.json": "1", "cam_extra.c": "1", "cam.sha256": "0  cam_extra.c\n"}, out, "cam")
    (out / "mine.txt").write_text("mine")
    (out / "camera.json").write_text("another name's")
    (out / "cam_no_code.txt").write_text("of a version without a list")
    write_set({"cam.json": "2", "cam.sha256": "0  cam.json\n"}, out, "cam")
    held = {path.name: path.read_text() for path in out.iterdir()}
    assert held == {
        "cam.json": "2", "cam.sha256": "0  cam.json\n", "mine.txt": "mine",
        "camera.json": "another name's",
    }  # fmt: skip


def test_a_list_leads_to_no_file_elsewhere(tmp_path: Path) -> None:
    out = tmp_path / "out"
    (tmp_path / "precious").write_text("kept")
    write_set({"cam.sha256": "0  ../precious\n"}, out, "cam")
    write_set({"cam.sha256": ""}, out, "cam")
    assert (tmp_path / "precious").read_text() == "kept"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--out", "."], "this is the current directory"),
        (["--out", "file"], "this is a file"),
        (["--require", "0.1"], "--require: expected a limit"),
    ],
)
def test_a_place_or_a_requirement_that_is_none_ends_the_call_before_anything_is_fitted(
    options: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    monkeypatch.delattr(calibration, "calibrate_tables")
    shown = CliRunner().invoke(app, ["a.csv", *options])
    assert isinstance(shown.exception, WrongCallError)
    assert said in str(shown.exception)


def test_the_exit_code_says_whether_requirements_are_met(
    camera: Calibration, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(calibration, "calibrate", lambda *_, **__: camera)
    monkeypatch.setattr(products, "report", lambda *_, **__: "")  # a second each
    told = ["a.csv", "--out", str(tmp_path / "out"), "--require", "1deg@95%"]
    shown = CliRunner().invoke(app, told, standalone_mode=False)
    assert (shown.return_value, camera.verdict.word) == (0, "good")
    assert "requirement 1deg@95%: met - " in shown.output
    shown = CliRunner().invoke(app, [*told, "--require", "1arcsec@rms"], standalone_mode=False)
    assert shown.return_value == 3
    assert "requirement 1arcsec@rms: not met - " in shown.output


def test_a_long_document_is_written_without_the_time_that_indenting_takes() -> None:
    """Ten times that of writing: 4 s of a forged document of 6 MB."""
    short, long = {"a": [1.5, None], "b": "\u00b5"}, {"a": list(range(200_000)), "b": 2.5e-7}
    assert text_of(short) == '{\n "a": [\n  1.5,\n  null\n ],\n "b": "\\u00b5"\n}\n'
    assert text_of(long).count("\n") == 1
    assert json.loads(text_of(long)) == long
    with pytest.raises(ValueError, match="not JSON compliant"):
        text_of({"a": [float("nan")]})
