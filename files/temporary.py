"""Temporary files and directories that a killed process leaves, and the next one removes.

What is being made lies beside its place under a hidden name that ends in `SUFFIX` and carries the
number of the process, for people. `tempfile` removes nothing after a kill, and whether a process
still lives cannot be distinguished from its number, which may be another's by now or another
container's: so the maker holds a lock on the name (`files.locks`), and what nobody has locked is
stale.
"""

from __future__ import annotations

import os
import re
import secrets
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from files.locks import LockedError, lock_or_refuse, wait_for_lock

SUFFIX = ".sunatlas"
#: Names of what is made, and of the locks on them (`locks.lock_path`).
_NAME = re.compile(
    r"(?:\.(?=\.))?(?P<name>\.(?P<of>.+)\.\d+-[0-9a-f]{8}" + re.escape(SUFFIX) + r")(?:\.lock)?",
    re.DOTALL,
)
_TEMPORARY = "temporary"


@contextmanager
def temporary_file_beside(target: Path) -> Iterator[Path]:
    """Make an empty file beside a target.

    It is gone at the end unless it was renamed; so are stale files of the same target. The file has
    the permissions that the umask leaves.
    """
    with _name_beside(target) as path:
        path.touch(exist_ok=False)
        yield path


@contextmanager
def temporary_directory_beside(target: Path) -> Iterator[Path]:
    """Make a directory beside a target, for this user alone; it is gone at the end."""
    with _name_beside(target) as path:
        path.mkdir(mode=0o700)
        yield path
        shutil.rmtree(path)


@contextmanager
def temporary_directory() -> Iterator[Path]:
    """Make a directory among the system's temporary files; those of killed processes go."""
    with temporary_directory_beside(Path(tempfile.gettempdir()) / _TEMPORARY) as path:
        yield path


def remove_stale_files(directory: Path, of: str | None = None) -> None:
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
        entries = [entry.name for entry in directory.iterdir()]
    except OSError:
        return
    found = [match for name in entries if (match := _NAME.fullmatch(name))]
    for name in {match["name"] for match in found if of in (None, match["of"])}:
        with suppress(OSError, LockedError), lock_or_refuse(directory / name):
            _remove(directory / name)


@contextmanager
def _name_beside(target: Path) -> Iterator[Path]:
    """Lock a new name beside a target; whatever has it at the end is removed."""
    remove_stale_files(target.parent, target.name)
    name = f".{target.name}.{os.getpid()}-{secrets.token_hex(4)}{SUFFIX}"
    with wait_for_lock(path := target.with_name(name)):
        try:
            yield path
        finally:
            _remove(path)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)
