"""Temporary files and directories beside the place that they are for, of `tempfile`.

What is being made lies under a hidden name that ends in `SUFFIX`. A killed process leaves it; who
writes there a day later removes it.
"""

from __future__ import annotations

import secrets
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

SUFFIX = ".sunatlas"
_DAY = 86_400.0


@contextmanager
def temporary_file_beside(target: Path) -> Iterator[Path]:
    """Make an empty file beside a target, with the permissions that the umask leaves.

    It is gone at the end unless it was renamed.
    """
    path = target.with_name(f".{target.name}.{secrets.token_hex(4)}{SUFFIX}")
    path.touch(exist_ok=False)
    try:
        yield path
    finally:
        path.unlink(missing_ok=True)


@contextmanager
def temporary_directory_beside(target: Path) -> Iterator[Path]:
    """Make a directory beside a target, for this user alone; it is gone at the end."""
    remove_stale_files(target.parent, target.name)
    with tempfile.TemporaryDirectory(SUFFIX, f".{target.name}.", target.parent) as path:
        yield Path(path)


@contextmanager
def temporary_directory() -> Iterator[Path]:
    """Make a directory among the system's temporary files."""
    with tempfile.TemporaryDirectory(SUFFIX, "sunatlas-") as path:
        yield Path(path)


def remove_stale_files(directory: Path, of: str = "") -> None:
    """Remove what killed processes left in a directory a day ago or earlier.

    Parameters
    ----------
    directory
        That is looked through, not what is beneath it; nothing happens where it is not there.
    of
        Name of the target; of all by default.
    """
    for path in directory.glob(f".*{SUFFIX}"):
        with suppress(OSError):
            if path.name.startswith(f".{of}") and path.lstat().st_mtime < time.time() - _DAY:
                if path.is_dir() and not path.is_symlink():
                    shutil.rmtree(path)
                else:
                    path.unlink()
