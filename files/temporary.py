"""Scratch files and directories that a killed process leaves, and the next one removes.

What is being made lies beside its place under a hidden name that ends in `SUFFIX` and carries the
number of the process, for people. Whether that process still lives is not asked of the number,
which may be another's by now or another container's: the maker holds a lock on what it makes, which
the system releases when the process ends, however it ends. What nobody holds is a leftover.
"""

from __future__ import annotations

import os
import re
import secrets
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any

#: The module of that name; None on Windows.
fcntl: Any = import_module("fcntl") if os.name == "posix" else None

SUFFIX = ".sunatlas"
#: Where a system has no such locks, what is older than this is a leftover.
_OLD_S = 86_400.0
_NAME = re.compile(r"\.(?P<of>.+)\.\d+-[0-9a-f]{8}" + re.escape(SUFFIX), re.DOTALL)
_TEMPORARY = "temporary"

_Maker = Callable[[Path], int]


@contextmanager
def scratch_file(target: Path) -> Iterator[Path]:
    """Make an empty file beside a target.

    It is gone at the end unless it was renamed; so are leftovers of the same target. The file has
    the permissions that the umask leaves.
    """
    remove_leftovers(target.parent, target.name)
    descriptor, path = _made(target.parent, target.name, _new_file)
    try:
        yield path
    finally:
        path.unlink(missing_ok=True)
        _close(descriptor)


@contextmanager
def scratch_directory(target: Path) -> Iterator[Path]:
    """Make a directory beside a target, for this user alone; gone at the end as `scratch_file`."""
    remove_leftovers(target.parent, target.name)
    descriptor, path = _made(target.parent, target.name, _new_directory)
    try:
        yield path
    finally:
        shutil.rmtree(path)
        _close(descriptor)


@contextmanager
def temporary_directory() -> Iterator[Path]:
    """Make a directory among the system's temporary files; leftovers of killed processes go."""
    with scratch_directory(Path(tempfile.gettempdir()) / _TEMPORARY) as path:
        yield path


def remove_leftovers(directory: Path, of: str | None = None) -> None:
    """Remove what dead processes left in a directory.

    What cannot be removed, or is another user's, stays.

    Parameters
    ----------
    directory
        That is looked through, not what is beneath it; nothing happens where it is not there.
    of
        Name of the target; of all by default.
    """
    try:
        entries = [entry.name for entry in os.scandir(directory)]
    except OSError:
        return
    for name in entries:
        found = _NAME.fullmatch(name)
        if found and of in (None, found["of"]):
            _remove_dead(directory / name)


def _made(directory: Path, name: str, make: _Maker) -> tuple[int, Path]:
    """Make something of a name of its own, and lock it."""
    while True:
        path = directory / f".{name}.{os.getpid()}-{secrets.token_hex(4)}{SUFFIX}"
        with suppress(_TakenError):
            return make(path), path


class _TakenError(Exception):
    """Another process took what was just made, not locked yet, for a leftover."""


def _new_file(path: Path) -> int:
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o666)
    if fcntl is not None:
        return _locked(path, descriptor)
    os.close(descriptor)  # there nobody renames a file that is open
    return -1


def _new_directory(path: Path) -> int:
    path.mkdir(mode=0o700)
    if fcntl is None:
        return -1
    try:
        return _locked(path, os.open(path, os.O_RDONLY))
    except FileNotFoundError as error:
        raise _TakenError from error


def _locked(path: Path, descriptor: int) -> int:
    with suppress(OSError):  # no locks there: then nobody can take it for a leftover either
        fcntl.flock(descriptor, fcntl.LOCK_EX)
    if not is_at(path, descriptor):
        os.close(descriptor)
        raise _TakenError
    return descriptor


def is_at(path: Path, descriptor: int) -> bool:
    """Say whether what a descriptor is of is what now has that path."""
    try:
        return os.path.samestat(os.fstat(descriptor), path.lstat())
    except OSError:
        return False


def _remove_dead(path: Path) -> None:
    if fcntl is None:
        with suppress(OSError):
            if time.time() - path.lstat().st_mtime > _OLD_S:
                _remove(path)
        return
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except OSError:  # gone meanwhile, or another user's
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if is_at(path, descriptor):
            _remove(path)
    except OSError:  # held: its process lives
        return
    finally:
        os.close(descriptor)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _close(descriptor: int) -> None:
    if descriptor >= 0:
        os.close(descriptor)
