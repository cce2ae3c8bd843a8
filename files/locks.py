"""Locks for writing: of two processes one writes, the other waits or is refused.

Where writing takes seconds (tables of the survey, an export) the second waits, and says for whom;
where it may take hours (results) it is refused. The locks are filelock's: the system releases one
when its process ends, however it ends. The lock's file names the process, and is removed.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


class LockedError(RuntimeError):
    """Another process (`holder`, such as ``process 1234``) writes there."""

    def __init__(self, holder: str, place: Path, message: str = "") -> None:
        self.holder = holder
        said = f"another {holder} is writing to {place}; call again when it has ended, what it "
        super().__init__(message or said + "writes is kept")


@contextmanager
def wait_for_lock(place: Path, *, wait: bool = True) -> Iterator[None]:
    """Lock a path by a hidden file beside it; wait, with a line in the log, while another has it.

    Without `wait` LockedError is raised at once. OSError where no such file can be made.
    """
    import logging  # noqa: PLC0415 - with the next, as slow to load as a command's help

    from filelock import FileLock, Timeout  # noqa: PLC0415

    file = lock_path(place)
    # filelock would make the directory, and try for ever where no file can be made
    file.open("a").close()
    lock = FileLock(file)
    try:
        lock.acquire(blocking=False)
    except Timeout as error:
        if not wait:
            raise LockedError(_holder(file), place) from error
        said = "waiting for another %s, which writes to %s"
        logging.getLogger("sunatlas").warning(said, _holder(file), place)
        lock.acquire()
    try:
        with suppress(OSError):  # Windows lets nobody write to, read or remove a locked file
            file.write_text(f"{os.getpid()}\n")
        yield
    finally:
        with suppress(OSError):
            file.unlink()  # while it is locked: nobody else may have locked this name
        lock.release()


@contextmanager
def lock_or_refuse(place: Path) -> Iterator[None]:
    """Lock a path as `wait_for_lock`, but raise LockedError at once where another process has."""
    with wait_for_lock(place, wait=False):
        yield


@contextmanager
def directory_lock(directory: Path, *, alone: bool = False) -> Iterator[None]:
    """Lock a directory, for as long as its process lives; `alone`: OSError where another has.

    On Windows nothing is locked, and OSError is raised for `alone`.
    """
    try:
        import fcntl  # noqa: PLC0415 - not on every system
    except ImportError:
        if alone:
            raise OSError("directories cannot be locked here") from None
        yield
        return
    opened = os.open(directory, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB if alone else fcntl.LOCK_SH)
        yield
    finally:
        os.close(opened)


def lock_path(place: Path) -> Path:
    """Return the path of a place's lock."""
    return place.with_name(f".{place.name}.lock")


def _holder(file: Path) -> str:
    with suppress(OSError, ValueError):  # gone meanwhile, or not written yet
        return f"process {int(file.read_text())}"
    return "process"
