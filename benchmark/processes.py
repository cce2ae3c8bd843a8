"""Processes that end as they should: with the process they work for, and tidily on a signal.

A process that is killed cannot end those that work for it. So each asks the system for a signal
when its coordinator ends (Linux's ``PR_SET_PDEATHSIG``), and elsewhere, or should that be missed,
looks every half second. A request to terminate is taken as Ctrl-C is, so that what is half made
goes. What does not end so within two seconds, such as a compiler at work, is ended hard: what is on
disk is then as safe as when the process is killed. A server of several processes has longer.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from types import FrameType
from typing import NoReturn

from files.locks import LockedError

#: Exit codes after Ctrl-C and after a request to terminate.
INTERRUPTED, TERMINATED = 128 + signal.SIGINT, 128 + signal.SIGTERM
_PR_SET_PDEATHSIG = 1
_EVERY_S = 0.5

#: Signals that ask this process to end.
_told: list[int] = []
#: How long it then has to end tidily, seconds.
_tidy_s: list[float] = [0.8]
#: Whether the end was spoken of.
_said = threading.Event()


def terminate_as_interrupt() -> None:
    """Let SIGTERM unwind this process as Ctrl-C does; `exit_code` tells them apart.

    Either ends it for certain within two seconds.
    """
    _end_for_certain()
    sys.unraisablehook = _ignore_interrupt
    signal.signal(signal.SIGTERM, _tell)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # else it is to be ignored
        signal.signal(signal.SIGINT, _tell)


def take_time_to_end(seconds: float) -> None:
    """Let this process take longer to end tidily, as one that waits for others to end."""
    _tidy_s[0] = seconds


def end_in_time() -> None:
    """End this process soon after a signal, whatever it is at, without a word of its own."""
    _said.set()
    _end_for_certain()


def termination_requested() -> bool:
    """Say whether a signal asked this process to end.

    Whatever error ends it then is of that signal: some code makes another of a KeyboardInterrupt,
    such as an ImportError where an extension module was being loaded.
    """
    return bool(_told)


def end_if_requested() -> None:
    """Raise KeyboardInterrupt once more where a signal asked this process to end.

    The first one is lost where it meets a callback of a library, as of the compiler.
    """
    if termination_requested():
        raise KeyboardInterrupt


def exit_code() -> int:
    """Return the exit code of a process that was broken off: 143 after SIGTERM, else 130."""
    return 128 + _told[0] if _told else INTERRUPTED


def say_interrupted(line: str = "interrupted") -> None:
    """Write on standard error that this process was asked to end."""
    _said.set()
    with suppress(OSError, ValueError):  # nobody is left to read it
        sys.stderr.write(f"{line}\n")
        sys.stderr.flush()


@cache
def _end_for_certain() -> None:
    """End this process in time where a signal does not.

    Python calls its handlers between two instructions of its own: never while a library's call
    lasts. The system's handler writes to a descriptor at once.
    """
    heard, hear = os.pipe()
    os.set_blocking(hear, False)
    signal.set_wakeup_fd(hear, warn_on_full_buffer=False)

    def wait() -> None:
        number = 0
        while number not in {signal.SIGINT, signal.SIGTERM}:
            number = os.read(heard, 1)[0]
        time.sleep(_tidy_s[0])
        if not _said.is_set():
            say_interrupted()
        os._exit(128 + number)

    threading.Thread(target=wait, daemon=True, name="end for certain").start()


def _ignore_interrupt(raised: sys.UnraisableHookArgs) -> None:
    """Say nothing of an interrupt that a callback ignores: what it was to end is ended later."""
    if not issubclass(raised.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(raised)


def _tell(number: int, _: FrameType | None) -> None:
    _told.append(number)
    raise KeyboardInterrupt


def call_to_end(main: Callable[[], int]) -> NoReturn:
    """Run a program to its end: as every `python -m` of the project does.

    SIGTERM is as Ctrl-C, exit codes are those of `exit_code`; where another process writes
    already, one line on standard error says so.
    """
    terminate_as_interrupt()
    try:
        status = main()
    except KeyboardInterrupt as error:
        say_interrupted(str(error) or "interrupted")
        status = exit_code()
    except LockedError as error:
        sys.stderr.write(f"{error}\n")
        status = 1
    except Exception:
        if not termination_requested():
            raise
        say_interrupted()
        status = exit_code()
    sys.exit(status)


def work_for(coordinator: int) -> None:
    """Begin as a worker: is killed with its coordinator, which alone answers Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform == "linux":
        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, int(signal.SIGKILL), 0, 0, 0)
    if os.getppid() != coordinator:  # it ended before this could be asked for
        os.kill(os.getpid(), signal.SIGKILL)
    _watch(coordinator)


@cache
def _watch(coordinator: int) -> None:
    def watch() -> None:
        while os.getppid() == coordinator:
            time.sleep(_EVERY_S)
        os.kill(os.getpid(), signal.SIGKILL)

    threading.Thread(target=watch, daemon=True, name="end with the coordinator").start()


def release_free_memory() -> None:
    """Give memory that is free back to the system; nothing where that cannot be said."""
    if sys.platform == "linux":
        with suppress(AttributeError):  # another C library than glibc
            ctypes.CDLL(None).malloc_trim(0)
