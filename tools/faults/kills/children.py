"""Programs run as children of this process, killed, and what they leave of processes and files.

A child is forked, so that what it imports is there already; it leads a session of its own, by which
its workers are found whoever they belong to by then.
"""

from __future__ import annotations

import atexit
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from benchmark.processes import exit_code

#: How long workers may live on, and a program may take.
GRACE_S = 2.0
PATIENCE_S = 120.0
#: Where a child keeps what is temporary, and what it says.
TEMPORARY, SAID = "temporary", "said.txt"


@dataclass
class Child:
    """A forked process."""

    process: int
    place: Path
    started: float

    def kill(self, number: int) -> None:
        """Send a signal; Ctrl-C goes to all of its session, as a terminal sends it."""
        with suppress(ProcessLookupError):
            if number == signal.SIGINT:
                os.killpg(self.process, number)
            else:
                os.kill(self.process, number)

    def wait(self) -> int:
        """Wait for its end and return its exit code, negative for a signal's number."""
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            found, status = os.waitpid(self.process, os.WNOHANG)
            if found:
                return os.waitstatus_to_exitcode(status)
            time.sleep(0.005)
        for process in (self.process, *session(self.process)):
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        os.waitpid(self.process, 0)
        raise TimeoutError(f"it went on for {PATIENCE_S:.0f} s: {self.said()}")

    def lasting(self) -> list[str]:
        """Processes of its session that live `GRACE_S` after its end; killed then."""
        deadline = time.monotonic() + GRACE_S
        while (left := session(self.process)) and time.monotonic() < deadline:
            time.sleep(0.02)
        numbers = list(left.values())
        for process in left:
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        return numbers

    def said(self) -> str:
        """Return what it wrote on standard error, the end of it."""
        return (self.place.parent / SAID).read_text(errors="replace")[-600:]


def start(act: Callable[[], object], place: Path) -> Child:
    """Start a program in a directory."""
    sys.stdout.flush()
    sys.stderr.flush()
    ready, numbers = os.pipe()
    process = os.fork()
    if process:
        os.close(numbers)
        os.read(ready, 1)  # it leads its session from here on
        os.close(ready)
        return Child(process, place, time.monotonic())
    status = 70
    try:
        os.setsid()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        _settle(place)
        os.close(numbers)
        status = _status(act)
    except BaseException:  # noqa: BLE001 - a child never returns into its parent's code
        traceback.print_exc()
    finally:
        os._exit(status)


def _settle(place: Path) -> None:
    os.chdir(place)
    temporary = place.parent / TEMPORARY
    temporary.mkdir(exist_ok=True)
    os.environ |= {"TMPDIR": str(temporary), "JOBLIB_TEMP_FOLDER": str(temporary)}
    tempfile.tempdir = None
    said = os.open(place.parent / SAID, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    nothing = os.open(os.devnull, os.O_RDWR)
    for standard, now in ((0, nothing), (1, nothing), (2, said)):
        os.dup2(now, standard)


def _status(act: Callable[[], object]) -> int:
    """Run a program and end as the interpreter does, short of leaving this process."""
    status: object = 0
    try:
        try:
            act()
        except SystemExit as ended:
            status = ended.code or 0
        threading._shutdown()
        atexit._run_exitfuncs()
    except KeyboardInterrupt:  # at the very end
        status = exit_code()
    return status if isinstance(status, int) else 1


def run(act: Callable[[], object], place: Path) -> tuple[int, float]:
    """Run a program to its end; its exit code and how long it took, seconds."""
    child = start(act, place)
    code = child.wait()
    return code, time.monotonic() - child.started


def session(leader: int) -> dict[int, str]:
    """Processes of a session that live, the leader left out, with what they are."""
    found = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal() and int(entry.name) != leader:
            with suppress(OSError, IndexError):
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
                if fields[0] != "Z" and int(fields[3]) == leader:
                    command = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode()
                    found[int(entry.name)] = command[-120:]
    return found


def contents(place: Path, varying: tuple[str, ...] = ()) -> dict[str, bytes | None]:
    """Bytes of every file in a place and among its temporary ones; None where they vary."""
    return dict(_contents(place, varying))


def _contents(place: Path, varying: tuple[str, ...]) -> Iterator[tuple[str, bytes | None]]:
    for top in (place, place.parent / TEMPORARY):
        for path in sorted(top.rglob("*")):
            name = f"{top.name}/{path.relative_to(top).as_posix()}"
            if path.is_dir():
                yield f"{name}/", None
            else:
                yield name, None if path.name in varying else path.read_bytes()


def fresh(template: Path, work: Path) -> Path:
    """Make a place that holds what a template does."""
    shutil.rmtree(work, ignore_errors=True)
    shutil.copytree(template, work / "place")
    return work / "place"
