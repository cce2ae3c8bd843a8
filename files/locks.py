"""Holding a place for writing: of two processes one writes, the other waits or is refused.

Where writing takes seconds (tables of the survey, an export, a bundle) the second waits, and says
for whom. Where it may take hours (results, curves, outcomes of claims) it is refused at once. The
system releases a lock when the process ends, however it ends, so that none can be stale; its file
goes with it, and the one a killed process leaves is the next one's.
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any

from files.temporary import fcntl, is_at

#: The module of that name, where this system has no flock.
filelock: Any = None if fcntl else import_module("filelock")
_LOG = logging.getLogger("sunatlas")
_EVERY_S = 0.05


class HeldError(RuntimeError):
    """Another process writes there; the message names both.

    Attributes
    ----------
    holder
        The process, such as ``process 1234``.
    """

    def __init__(self, holder: str, place: Path, message: str = "") -> None:
        self.holder = holder
        super().__init__(
            message
            or f"another {holder} is writing to {place}; call again when it has ended, what it "
            "writes is kept"
        )


@contextmanager
def held_in_turn(place: Path) -> Iterator[None]:
    """Hold a place; wait, with a line that says so, while another process does.

    Parameters
    ----------
    place
        What is written. The lock is a hidden file beside it, in a directory that exists.

    Raises
    ------
    OSError
        Where no such file can be made.
    """
    file = lock_file(place)
    held = _attempt(file)
    if held is None:
        _LOG.warning("waiting for another %s, which writes to %s", _holder(file), place)
    while held is None:
        time.sleep(_EVERY_S)
        held = _attempt(file)
    with _released(file, held):
        yield


@contextmanager
def held_alone(place: Path) -> Iterator[None]:
    """Hold a place, or raise HeldError at once when another process does; else `held_in_turn`."""
    file = lock_file(place)
    held = _attempt(file)
    if held is None:
        raise HeldError(_holder(file), place)
    with _released(file, held):
        yield


def lock_file(place: Path) -> Path:
    """Return the path of a place's lock."""
    return place.with_name(f".{place.name}.lock")


def _attempt(file: Path) -> Any:
    """Lock a file, which is made, and return its descriptor; None where another process has it."""
    if fcntl is None:
        try:
            return filelock.FileLock(file).acquire(timeout=0).lock
        except filelock.Timeout:
            return None
    while True:
        descriptor = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            return None
        except BaseException:
            os.close(descriptor)
            raise
        if is_at(file, descriptor):  # else its holder removed it: the lock is of no name now
            os.ftruncate(descriptor, 0)
            os.write(descriptor, f"{os.getpid()}\n".encode())
            return descriptor
        os.close(descriptor)


@contextmanager
def _released(file: Path, held: Any) -> Iterator[None]:
    try:
        yield
    finally:
        if fcntl:
            file.unlink(missing_ok=True)  # while it is locked: nobody else may hold this name
            os.close(held)
        else:
            held.release()


def _holder(file: Path) -> str:
    number = ""
    with suppress(OSError, ValueError):  # gone meanwhile; Windows lets nobody read a locked file
        number = str(int(file.read_text()))
    return f"process {number}" if number else "process"
