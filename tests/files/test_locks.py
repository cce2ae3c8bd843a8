"""One process writes to a place at a time; a lock ends with its process and leaves no file."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

import survey_data
from files.locks import LockedError, lock_or_refuse, wait_for_lock

ROOT = Path(survey_data.__file__).parent.parent
LOCK_AND_WAIT = """
import sys
from pathlib import Path
from files.locks import lock_or_refuse
with lock_or_refuse(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def place(tmp_path: Path) -> Path:
    return tmp_path / "out"


@pytest.fixture
def holder(place: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that holds the place until its standard input ends."""
    command = [sys.executable, "-c", LOCK_AND_WAIT, str(place)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


def test_another_is_refused_until_the_first_is_killed(
    place: Path, holder: subprocess.Popen[str]
) -> None:
    expected = f"another process {holder.pid} is writing to {place}"
    with pytest.raises(LockedError, match=expected), lock_or_refuse(place):
        pytest.fail("two hold it")
    holder.kill()
    holder.wait()
    with pytest.raises(RuntimeError, match="inside"), lock_or_refuse(place):
        raise RuntimeError("inside")
    assert list(place.parent.iterdir()) == [], "the lock's file goes with it"


def test_one_that_waits_says_for_whom_and_goes_on_when_the_first_has_ended(
    place: Path, holder: subprocess.Popen[str], caplog: pytest.LogCaptureFixture
) -> None:
    entered = threading.Event()

    def wait() -> None:
        with wait_for_lock(place):
            entered.set()

    waiting = threading.Thread(target=wait)
    waiting.start()
    assert not entered.wait(0.3)
    assert holder.stdin is not None
    holder.stdin.close()
    waiting.join(60)
    assert entered.is_set()
    assert caplog.messages == [f"waiting for another process {holder.pid}, which writes to {place}"]


def test_many_that_come_and_go_never_meet(place: Path) -> None:
    """Each removes the file of the lock at its end: nobody may hold one without a name."""
    inside: list[int] = []
    met: list[int] = []

    def work() -> None:
        for _ in range(30):
            with wait_for_lock(place):
                inside.append(1)
                met.append(len(inside))
                inside.pop()

    threads = [threading.Thread(target=work) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert met == [1] * 180
