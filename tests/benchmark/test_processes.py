"""Processes end with those they work for, and tidily on a signal."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

import pytest

import benchmark
from benchmark import processes
from files.locks import LockedError

ROOT = Path(benchmark.__file__).parents[1]
PROGRAM = """
import sys, time
from pathlib import Path
from benchmark.processes import call_to_end
from files.atomic import temporary_directory_beside

def main():
    with temporary_directory_beside(Path(sys.argv[1]) / "out"):
        print("working", flush=True)
        time.sleep(600)

call_to_end(main)
"""
#: Says the numbers of the workers of a pool, of which one works and the others wait.
POOL = """
import os, sys, time
from benchmark.running.workers import as_completed
sys.path.append(sys.argv[1])
from sleeping import sleep
for pid in as_completed(sleep, [0, 0, 0, 600], 2):
    print(pid, flush=True)
"""


def start(*command: object) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", *map(str, command)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        # else a run in a shell's background, where Ctrl-C is ignored, hands that on
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509
    )


def first_line(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    return process.stdout.readline().strip()


def ended(process: int) -> bool:
    """Wait for a process of another parent; far less than it would go on by itself."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        try:
            state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
        except OSError:
            return True
        if state == "Z":
            return True
        time.sleep(0.02)
    return False


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_program_that_is_told_to_end_removes_what_it_was_making(
    tmp_path: Path, number: signal.Signals, code: int
) -> None:
    process = start(PROGRAM, tmp_path)
    assert first_line(process) == "working"
    assert len(list(tmp_path.iterdir())) == 1
    process.send_signal(number)
    _, said = process.communicate(timeout=60)
    assert (process.returncode, said) == (code, "interrupted\n")
    assert list(tmp_path.iterdir()) == []


def test_an_error_that_a_signal_was_made_into_ends_as_the_signal_does(tmp_path: Path) -> None:
    """As where an extension module is being loaded: its ImportError says nothing of the signal."""
    program = (
        "import time\n"
        "from benchmark.processes import call_to_end\n"
        "def main():\n"
        "    try:\n        print('working', flush=True); time.sleep(600)\n"
        "    except KeyboardInterrupt:\n        raise ImportError('initialization failed')\n"
        "call_to_end(main)\n"
    )
    process = start(program)
    assert first_line(process) == "working"
    process.terminate()
    _, said = process.communicate(timeout=60)
    assert (process.returncode, said) == (143, "interrupted\n")


def test_a_second_writer_is_told_in_one_line(tmp_path: Path) -> None:
    program = (
        "import sys; from pathlib import Path\n"
        "from benchmark.processes import call_to_end\n"
        "from files.locks import lock_or_refuse\n"
        "def main():\n"
        "    with lock_or_refuse(Path(sys.argv[1])), lock_or_refuse(Path(sys.argv[1])): pass\n"
        "call_to_end(main)\n"
    )
    process = start(program, tmp_path / "out")
    _, said = process.communicate(timeout=60)
    assert process.returncode == 1
    assert said.count("\n") == 1
    assert f"another process {process.pid} is writing to {tmp_path / 'out'}" in said


@pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")
@pytest.mark.parametrize(
    "number", [signal.SIGKILL, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)]
)
def test_workers_end_with_their_coordinator_busy_or_not(
    tmp_path: Path, number: signal.Signals
) -> None:
    (tmp_path / "sleeping.py").write_text(
        "import os, time\n"
        "def sleep(seconds):\n    time.sleep(seconds or 0.2)\n    return os.getpid()\n"
    )
    coordinator = start(POOL, tmp_path)
    workers = {int(first_line(coordinator)) for _ in range(3)}
    coordinator.send_signal(number)
    coordinator.communicate(timeout=60)
    assert workers
    assert os.getpid() not in workers
    assert all(ended(worker) for worker in workers)


def raiser(error: BaseException) -> Callable[[], int]:
    def main() -> NoReturn:
        raise error

    return main


@pytest.fixture
def calm(monkeypatch: pytest.MonkeyPatch) -> None:
    """Signals of this process stay as they are, and nothing has asked it to end."""
    monkeypatch.setattr(processes, "terminate_as_interrupt", lambda: None)
    monkeypatch.setattr(processes, "_told", [])
    monkeypatch.setattr(processes, "_said", threading.Event())


@pytest.mark.usefixtures("calm")
@pytest.mark.parametrize(
    ("main", "code", "said"),
    [
        (lambda: 3, 3, ""),
        (raiser(KeyboardInterrupt()), 130, "interrupted\n"),
        (raiser(KeyboardInterrupt("half is done")), 130, "half is done\n"),
        (raiser(LockedError("process 7", Path("out"), "7 is writing")), 1, "7 is writing\n"),
    ],
)
def test_a_program_ends_with_the_code_of_what_ended_it(
    main: Callable[[], int], code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ending:
        processes.call_to_end(main)
    assert ending.value.code == code
    assert capsys.readouterr().err == said
