"""The campaign of kills sees what it is for, and a small one of it finds nothing."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

# Processes are looked up in /proc.
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc"),
]

#: The campaign on a program that makes a file in two halves, leaves a scratch file and a process.
SLOPPY = """
import subprocess, sys, time
from pathlib import Path
from tools.faults.kills import commands, __main__ as campaign

def act():
    scratch = Path(f"scratch-{time.monotonic_ns()}")
    scratch.touch()
    worker = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    with Path("made").open("a") as file:
        for _ in range(20):
            file.write("half ")
            file.flush()
            time.sleep(0.05)
    scratch.unlink()
    worker.kill()
    worker.wait()

commands.COMMANDS = campaign.COMMANDS = {"sloppy": commands.Command("sloppy", lambda: None, act)}
for name in ("trials", "report"):
    sys.modules[f"tools.faults.kills.{name}"].COMMANDS = commands.COMMANDS
sys.exit(campaign.main(["--kills", "2", "--no-pairs"]))
"""


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *command], check=False, capture_output=True, text=True, cwd=ROOT
    )


def test_a_sloppy_program_is_told_with_each_of_its_faults() -> None:
    found = run("-c", SLOPPY)
    assert found.returncode == 1, found.stderr
    for fault in ("1 workers live on", "1 left behind: place/scratch-", "1 of other bytes"):
        assert fault in found.stdout


def test_kills_of_quick_programs_leave_nothing() -> None:
    only = [word for name in ("error_budget", "gc", "pin") for word in ("--only", name)]
    found = run("-m", "tools.faults.kills", "--kills", "9", "--no-pairs", *only)
    assert found.returncode == 0, found.stdout + found.stderr
    assert "9 kills" in found.stdout
