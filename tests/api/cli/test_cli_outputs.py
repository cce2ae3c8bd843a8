"""Commands that make a directory: whole, or nothing and one sentence."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app

ROOT = Path(__file__).resolve().parents[3]
#: Runs a command where no file may grow beyond so many bytes, as on a disk that is full; of the
#: bundle's samples those of one data set, which take a second.
LIMITED = """
import resource, sys
from functools import partial
from api.cli.command_line import main
from api.deposit import bundle

bundle.build = partial(bundle.build, frames=("pd-slit",))
size = int(sys.argv[1])
if size:
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
sys.argv[1:2] = []
main()
"""
COMMANDS = {
    "deposit": ["deposit", "build"],
    "guide": ["guide", "build"],
    "export": ["dataset", "export", "ccd-slit", "--n", "20"],
}


def start(size: int, out: Path, name: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", LIMITED, str(size), *COMMANDS[name], "--out", str(out)],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def everything(directory: Path) -> list[str]:
    return sorted(path.relative_to(directory).as_posix() for path in directory.rglob("*"))


@pytest.mark.parametrize("name", COMMANDS)
def test_the_root_of_files_is_refused_at_once(name):
    shown = CliRunner().invoke(app, [*COMMANDS[name], "--out", "/"], catch_exceptions=False)
    assert shown.exit_code == 1
    assert shown.stderr.count("\n") == 1
    assert re.search(r"\s/: .*directory", shown.stderr)


@pytest.mark.parametrize("name", COMMANDS)
def test_somebody_else_s_directory_is_not_replaced(name, tmp_path):
    (tmp_path / "thesis.tex").write_text("irreplaceable")
    shown = CliRunner().invoke(app, [*COMMANDS[name], "--out", str(tmp_path)])
    assert shown.exit_code == 1
    assert shown.stderr.count("\n") == 1
    assert "nothing was written" in shown.stderr
    assert everything(tmp_path) == ["thesis.tex"]


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_a_command_that_is_stopped_leaves_nothing(name, end, tmp_path):
    process = start(0, tmp_path / "new" / "out", name)
    for _ in range(6000):
        if any(tmp_path.rglob("*.sunatlas")) or process.poll() is not None:
            break
        time.sleep(0.01)
    time.sleep(0.3)
    process.send_signal(end)
    _, err = process.communicate(timeout=120)
    assert process.returncode in ({130} if end is signal.SIGINT else {143}), err
    assert "Traceback" not in err
    assert everything(tmp_path) == []
