"""The process of a calibration ends with who waits for it, and leaves no file of a stranger."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from calibrate import uploaded
from calibrate.uploaded import Caller, Upload, UploadRefusedError, calibrate_uploads

ROOT = Path(__file__).resolve().parents[2]


def test_the_process_of_a_caller_that_is_gone_ends_and_removes_the_files(tmp_path: Path) -> None:
    """Its input ends with the process that holds the other end, even where that is killed."""
    directory = tmp_path / "uploaded"
    (directory / "0").mkdir(parents=True)
    (directory / "0" / "bench.csv").write_bytes(b"a stranger's")
    os.mkfifo(directory / "task.json")  # which nobody writes: the process waits to read it
    command = [sys.executable, "-m", "calibrate.uploaded", str(directory)]
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE) as process:
        assert process.stdin is not None
        process.stdin.close()
        assert process.wait(timeout=600) == 1
    assert list(tmp_path.iterdir()) == []


def test_who_hung_up_is_refused_and_nothing_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    caller = Caller()
    caller.hang_up()
    with pytest.raises(UploadRefusedError):
        calibrate_uploads([Upload("bench.csv", b"x_px,y_px,alpha,beta\n")], caller=caller)
    assert list(tmp_path.iterdir()) == []


def test_a_calibration_takes_the_processor_that_no_answer_wants(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "task.json")
    command = [sys.executable, "-c", uploaded._BEGIN, str(tmp_path)]
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stderr=-1) as process:
        with (tmp_path / "task.json").open("w"):  # opened when the process reads it
            assert os.getpriority(os.PRIO_PROCESS, process.pid) == 19
            if hasattr(os, "SCHED_IDLE"):
                assert os.sched_getscheduler(process.pid) == os.SCHED_IDLE
        process.communicate(timeout=600)
    assert process.returncode == 1, "it was told to do nothing that it knows"
