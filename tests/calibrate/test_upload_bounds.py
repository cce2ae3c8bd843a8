"""Files that are sent are refused beyond their bounds, and where their process ends early."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from calibrate import uploaded
from calibrate.uploaded import Upload, UploadRefusedError, calibrate_uploads

ROOT = Path(__file__).resolve().parents[2]
FILE = Upload("bench.csv", b"x_px,y_px,alpha,beta\n" + 5 * b"1,2,3,4\n")


@pytest.mark.parametrize(
    ("uploads", "config", "said"),
    [
        ([], "", "expected 1 to 20 files; got 0"),
        ([FILE] * 21, "", "expected 1 to 20 files; got 21"),
        ([Upload("a.csv", bytes(6_000_000))] * 2, "", "at most 10000000 bytes; got 12000000"),
        ([FILE], "#" * 20_001, "config: expected at most 20000 characters; got 20001"),
    ],
    ids=["no file", "21 files", "12 MB", "a long config"],
)
def test_what_is_beyond_the_bounds_is_refused_before_a_process_starts(
    uploads: list[Upload], config: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(subprocess, "run")
    with pytest.raises(UploadRefusedError, match=said):
        calibrate_uploads(uploads, config)


@pytest.mark.parametrize(
    ("status", "said"),
    [
        (-9, "killed, most likely for want of memory"),
        (-11, "ended by SIGSEGV"),
        (-24, "took over 60 s; send fewer rows"),
        (0, "ended without an answer"),
    ],
)
def test_a_process_that_leaves_no_answer_is_a_refusal_with_its_cause(
    status: int, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ended(command: list[str], **_: Any) -> subprocess.CompletedProcess[bytes]:
        return subprocess.CompletedProcess(command, status)

    monkeypatch.setattr(subprocess, "run", ended)
    with pytest.raises(UploadRefusedError, match=said):
        calibrate_uploads([FILE])


@pytest.fixture
def task(tmp_path: Path) -> Path:
    """A directory as the process finds it."""
    (tmp_path / "0").mkdir()
    (tmp_path / "0" / "bench.csv").write_bytes(FILE.data)
    stated = {"names": ["0/bench.csv"], "config": "", "apply": False, "model": ""}
    (tmp_path / "task.json").write_text(json.dumps(stated), encoding="utf-8")
    return tmp_path


def refusal(directory: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """What the process leaves, run here without its limits of memory and time."""
    monkeypatch.setattr("resource.setrlimit", lambda *_: None)
    assert uploaded.main([str(directory)]) == 0
    said = json.loads((directory / "said.json").read_text(encoding="utf-8"))
    return str(said["refused"])


def test_more_rows_than_a_calibration_may_have_are_refused(
    task: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(uploaded, "MOST_ROWS", 4)
    assert refusal(task, monkeypatch) == "expected at most 4 rows in all; got 5"


def test_a_process_is_bounded_by_the_time_of_the_processor(
    task: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Others that keep the machine busy take nothing of it."""
    begun = "from calibrate import uploaded as u; u.LONGEST_S = 2; u._answer = lambda _: spin()\n"
    spin = "def spin():\n while True: pass\n"
    code = f"{begun}{spin}u.main({[str(task)]!r})"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, timeout=600, check=False)
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: done)
    with pytest.raises(UploadRefusedError, match="the calibration took over 60 s; send fewer rows"):
        calibrate_uploads([FILE])


@pytest.mark.parametrize("depth", [2_000, 19_000])
def test_a_config_nested_too_deep_is_said_to_be_at_fault(
    task: Path, monkeypatch: pytest.MonkeyPatch, depth: int
) -> None:
    stated = {"names": ["0/bench.csv"], "config": "a = " + "[" * depth, "apply": False}
    (task / "task.json").write_text(json.dumps(stated), encoding="utf-8")
    assert refusal(task, monkeypatch).startswith("config: ")


def test_an_error_of_the_program_is_called_one(task: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is no want of memory; the server's log has the traceback."""
    monkeypatch.setattr("resource.setrlimit", lambda *_: None)
    monkeypatch.setattr("calibrate.uploaded.calibrate", lambda *_, **__: 1 / 0)
    assert uploaded.main([str(task)]) == 0
    said = json.loads((task / "said.json").read_text(encoding="utf-8"))
    assert said["fault"] == "ZeroDivisionError: division by zero"
    assert "Traceback" in said["trace"]

    def answered(command: list[str], **_: Any) -> subprocess.CompletedProcess[bytes]:
        (Path(command[-1]) / "said.json").write_text(json.dumps(said), encoding="utf-8")
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(subprocess, "run", answered)
    with pytest.raises(UploadRefusedError, match=r"division by zero\); this is a fault of the pro"):
        calibrate_uploads([FILE])
