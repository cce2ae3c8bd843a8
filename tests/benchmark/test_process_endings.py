"""How a process ends, told without ending the one that runs the tests."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NoReturn

import pytest

from benchmark import processes
from files.locks import LockedError

#: Of no process.
NOBODY = -4711


class Killed:
    """Takes the signals that this process would send itself."""

    def __init__(self) -> None:
        self.signals: list[tuple[int, int]] = []
        self.came = threading.Semaphore(0)

    def __call__(self, process: int, number: int) -> None:
        self.signals.append((process, number))
        self.came.release()


@pytest.fixture
def killed(monkeypatch: pytest.MonkeyPatch) -> Killed:
    taker = Killed()
    monkeypatch.setattr(os, "kill", taker)
    return taker


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """What the C library is asked for."""
    calls: list[tuple[Any, ...]] = []

    class Library:
        def __init__(self, _: None) -> None: ...

        def prctl(self, *given: int) -> None:
            calls.append(("prctl", *given))

        def malloc_trim(self, *given: int) -> None:
            calls.append(("malloc_trim", *given))

    monkeypatch.setattr(ctypes, "CDLL", Library)
    return calls


@pytest.fixture
def interruptible() -> Iterator[None]:
    before = signal.getsignal(signal.SIGINT)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.skipif(sys.platform != "linux", reason="asks Linux")
@pytest.mark.usefixtures("interruptible")
def test_a_worker_whose_coordinator_has_ended_already_ends_itself_at_once(
    killed: Killed, asked: list[tuple[Any, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    # a process is watched once: here, as if none had been
    monkeypatch.setattr(processes, "_watch", processes._watch.__wrapped__)
    processes.work_for(NOBODY)
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN, "its coordinator answers Ctrl-C"
    assert asked == [("prctl", 1, signal.SIGKILL, 0, 0, 0)]
    for _ in range(2):  # at once, and by who looks every half second
        assert killed.came.acquire(timeout=60)
    assert killed.signals == [(os.getpid(), signal.SIGKILL)] * 2


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
    monkeypatch.delenv(processes.COORDINATOR, raising=False)


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


@pytest.mark.usefixtures("calm")
def test_an_error_is_the_programs_own_unless_a_signal_came(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    main = raiser(ImportError("initialization failed"))
    with pytest.raises(ImportError, match="initialization failed"):
        processes.call_to_end(main)
    monkeypatch.setattr(processes, "_told", [signal.SIGTERM])
    with pytest.raises(SystemExit) as ending:
        processes.call_to_end(main)
    assert ending.value.code == 143
    assert capsys.readouterr().err == "interrupted\n"
    with pytest.raises(KeyboardInterrupt):
        processes.end_if_requested()
