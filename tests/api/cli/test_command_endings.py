"""How a command ends: its exit code and one line on stderr, whatever goes wrong."""

from __future__ import annotations

import errno
import os
import signal
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass

import pytest
import typer
from typer.core import TyperCommand

from api.cli import command_line
from benchmark import processes

NO_MEMORY = "out of memory; allow this process more (`ulimit -v`), or use fewer --workers"
FULL = OSError(errno.ENOSPC, "No space left on device")


@dataclass
class Ended:
    """Exit code, and what was printed."""

    code: object
    out: str
    err: str


@pytest.fixture
def ending(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[[Callable[[], None]], Ended]:
    """Run a command that does what is given, as `sunatlas compile` is run."""

    def run(does: Callable[[], None]) -> Ended:
        monkeypatch.setattr(command_line, "load", lambda _: TyperCommand("compile", callback=does))
        with pytest.raises(SystemExit) as ended:
            typer.main.get_command(command_line.app).main(["compile"], prog_name="sunatlas")
        return Ended(ended.value.code, *capsys.readouterr())

    return run


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Signals that asked this process to end; none so far."""
    signals: list[int] = []
    monkeypatch.setattr(processes, "_told", signals)
    monkeypatch.setattr(processes, "_said", threading.Event())
    return signals


def raising(error: BaseException) -> Callable[[], None]:
    def does() -> None:
        raise error

    return does


@pytest.mark.usefixtures("told")
@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (typer.Abort(), 1, "sunatlas: aborted\n"),
        (typer.Exit(3), 3, ""),
        (BrokenPipeError(errno.EPIPE, "Broken pipe"), 1, ""),
        (KeyboardInterrupt(), 130, "sunatlas: interrupted\n"),
        (KeyboardInterrupt("1 of 2 is kept"), 130, "sunatlas: 1 of 2 is kept\n"),
        (FULL, 1, "sunatlas: standard output: No space left on device\n"),
        (OSError(errno.EACCES, "Denied"), 1, "sunatlas: Denied\n"),
        (OSError(errno.EACCES, "Denied", "/a/b.csv"), 1, "sunatlas: /a/b.csv: Denied\n"),
        (MemoryError(), 1, f"sunatlas: {NO_MEMORY}\n"),
        (
            ImportError("x.so: failed to map segment from shared object"),
            1,
            f"sunatlas: {NO_MEMORY}\n",
        ),
        (
            OSError(errno.EMFILE, "Too many open files", "/a"),
            1,
            "sunatlas: /a: Too many open files\n",
        ),
        (
            OSError(errno.EACCES, "Denied", "/a/.b.lock"),
            1,
            "sunatlas: cannot write in /a: Denied\n",
        ),
    ],
)
def test_an_error_becomes_an_exit_code_and_a_line(
    ending: Callable[[Callable[[], None]], Ended], error: BaseException, code: int, said: str
) -> None:
    assert ending(raising(error)) == Ended(code, "", said)


@pytest.mark.usefixtures("told")
def test_a_reader_who_has_gone_ends_it_in_silence_for_good(
    ending: Callable[[Callable[[], None]], Ended], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As `sunatlas studies | head`: what is still in the buffer does not fail once more."""
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as pipe:
        monkeypatch.setattr(sys, "stdout", pipe)
        assert ending(lambda: print("a table", file=pipe)) == Ended(1, "", "")
        pipe.write("more")


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize(
    "error", [ImportError("half loaded"), FULL, typer.Abort(), KeyboardInterrupt("interrupted")]
)
def test_an_error_after_a_signal_is_of_that_signal(
    ending: Callable[[Callable[[], None]], Ended],
    told: list[int],
    error: BaseException,
    number: int,
    code: int,
) -> None:
    told.append(number)
    assert ending(raising(error)) == Ended(code, "", "sunatlas: interrupted\n")


@pytest.mark.usefixtures("told")
def test_a_mistake_in_a_program_keeps_its_traceback(
    ending: Callable[[Callable[[], None]], Ended], monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ZeroDivisionError):
        ending(raising(ZeroDivisionError()))
    monkeypatch.setenv(command_line.DEBUG, "1")
    with pytest.raises(OSError, match="No space left") as shown:
        ending(raising(FULL))
    assert shown.value is FULL


@pytest.mark.usefixtures("told")
def test_a_closed_standard_output_is_said_before_anything_is_done(
    ending: Callable[[Callable[[], None]], Ended], monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[int] = []
    monkeypatch.setattr(sys, "stdout", None)
    ended = ending(lambda: done.append(1))
    assert (ended.code, ended.err) == (1, "sunatlas: standard output is closed\n")
    assert done == []
