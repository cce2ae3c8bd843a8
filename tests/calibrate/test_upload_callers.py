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
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: pytest.fail("a process began"))
    with pytest.raises(UploadRefusedError, match="hung up"):
        calibrate_uploads([Upload("bench.csv", b"x_px,y_px,alpha,beta\n")], caller=caller)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("service", "calibration"), [(0, 10), (15, 15)])
def test_a_calibration_steps_back_behind_answers_from_before_it_loads_the_program(
    service: int, calibration: int
) -> None:
    """And never forward, which a user may not: it would end there."""
    instead = "import os, runpy; runpy.run_module = lambda *_, **__: print(os.getpriority(0, 0))"
    own = os.getpriority(0, 0)  # only a privileged process may step forward
    begun = f"{instead}; os.setpriority(0, 0, {max(service, own)})"
    command = [sys.executable, "-c", f"{begun}\n{uploaded._BEGIN}"]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, timeout=600, check=True)
    assert int(found.stdout) == max(calibration, own)
