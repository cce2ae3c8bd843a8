"""Writing files and directories whole or not at all.

Everything is made beside its place, under a hidden name that ends in `SUFFIX`, and renamed into it:
who reads meanwhile sees the earlier content or the new one (for a moment no directory), and a
process that is killed leaves no half of either. The next writer removes its leftovers once they are
a day old.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from files.locks import directory_lock, wait_for_lock

SUFFIX, _PREFIX = ".sunatlas", "sunatlas-"
#: Seconds within which a directory that was made is locked.
_UNLOCKED_S = 5.0
#: Entries, of all depths, that a directory may hold whose files are replaced at once.
MOST_OTHERS = 10_000


class UnreplaceableError(ValueError):
    """A path that cannot be replaced as a whole; the message says why and what could be."""


def replace_file(path: Path, content: str | bytes) -> bool:
    """Write a file, text as UTF-8; on return it survives a power cut. Returns whether it changed.

    Directories above it are made. An earlier file keeps its permissions. An OSError names the file.
    """
    wanted = content.encode() if isinstance(content, str) else content
    if path.is_file() and path.read_bytes() == wanted:
        return False
    path.parent.mkdir(parents=True, exist_ok=True)
    with temporary_directory_beside(path) as scratch:
        _write(scratch / path.name, wanted, like=path)
        (scratch / path.name).replace(path)
    return True


@contextmanager
def temporary_directory() -> Iterator[Path]:
    """Make a directory among the system's temporary files; it is gone at the end.

    It is locked meanwhile, so that `sweep` knows it from one whose process was killed.
    """
    with tempfile.TemporaryDirectory(SUFFIX, _PREFIX) as path, directory_lock(Path(path)):
        yield Path(path)


def sweep() -> None:
    """Remove the temporary directories of this user whose processes are gone."""
    for left in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*{SUFFIX}"):
        with suppress(OSError):
            if left.lstat().st_mtime < time.time() - _UNLOCKED_S:
                with directory_lock(left, alone=True):
                    shutil.rmtree(left)


@contextmanager
def temporary_directory_beside(target: Path) -> Iterator[Path]:
    """Make a directory beside a target, for this user alone; it is gone at the end.

    An OSError in it names what was to be there: the target, or the place of a file within.
    """
    for left in target.parent.glob(f".{target.name}.*{SUFFIX}"):
        with suppress(OSError):
            if left.lstat().st_mtime < time.time() - 86_400:
                shutil.rmtree(left)
    with tempfile.TemporaryDirectory(SUFFIX, f".{target.name}.", target.parent) as made:
        try:
            yield Path(made)
        except OSError as error:
            if error.errno is not None:
                said = str(error.filename or target)
                error.filename = said.replace(made, str(target.parent))
            raise


@contextmanager
def replace_all(*targets: Path) -> Iterator[tuple[Path, ...]]:
    """Yield paths to make files and directories at, which then take their places.

    An earlier directory is moved aside for that (`.<name>.before`), for a moment: a kill in it
    leaves it there, and the next call puts it back first. An error in the block leaves the targets,
    all in one directory, as they are; UnreplaceableError as `require_replaceable`. Another process
    waits (`files.locks`).
    """
    for target in targets:
        require_replaceable(target)
    first = targets[0]
    first.parent.mkdir(parents=True, exist_ok=True)
    with wait_for_lock(first), temporary_directory_beside(first) as scratch:
        for target in targets:
            restore(target)
        yield tuple(scratch / target.name for target in targets)
        for target in targets:
            _put(scratch / target.name, target)


def restore(target: Path) -> None:
    """Put back what a killed process had moved aside; remove it if something is there again."""
    before = target.with_name(f".{target.name}.before")
    if os.path.lexists(before) and not os.path.lexists(target):
        before.rename(target)
    shutil.rmtree(before, ignore_errors=True)


def _put(path: Path, target: Path) -> None:
    if not target.is_dir() or target.is_symlink():
        path.replace(target)
    else:
        target.rename(target.with_name(f".{target.name}.before"))
        try:
            path.rename(target)
        finally:
            restore(target)


def require_replaceable(path: Path) -> None:
    """Raise UnreplaceableError for the root of a file system, where another cannot take its place.

    That is `/`, a drive, or where one is mounted.
    """
    if not path.name or (path.is_mount() and not path.is_symlink()):
        raise UnreplaceableError(
            f"{path}: the root of a file system cannot be replaced; expected a directory in it; "
            "nothing was written"
        )


def require_replaceable_directory(directory: Path) -> None:
    """Raise UnreplaceableError for a directory whose files cannot be replaced at once.

    That is a file, a root, the current directory or one above it, or one with too many other files.
    """
    try:
        place = directory.resolve()
        require_replaceable(place)
    except (OSError, RuntimeError) as error:  # a loop of symbolic links
        raise UnreplaceableError(f"{directory}: expected a directory ({error})") from None
    expected = "expected a directory that can be replaced as a whole"
    if place.exists() and not place.is_dir():
        raise UnreplaceableError(f"{directory}: expected a directory; this is a file")
    if Path.cwd().is_relative_to(place):
        raise UnreplaceableError(
            f"{directory}: {expected}; this is the current directory or above it. "
            f"Name one in it, such as {directory / 'calibration'}"
        )
    if sum(len(inner) + len(files) for _, inner, files in os.walk(place)) > MOST_OTHERS:
        raise UnreplaceableError(
            f"{directory}: {expected}, of at most {MOST_OTHERS} files; name a new one"
        )


def replace_in_directory(
    directory: Path, files: Mapping[str, bytes], gone: Collection[str] = ()
) -> None:
    """Put files, by name, into a directory, all of them or none; others stay, but those `gone`.

    It is made where it is not there. Raises as `require_replaceable_directory` and `replace_file`.
    """
    require_replaceable_directory(directory)
    place = directory.resolve()
    with replace_all(place) as (new,):
        if place.is_dir():
            others = {*files, *gone}
            shutil.copytree(
                place,
                new,
                symlinks=True,
                copy_function=_link,
                ignore=lambda where, _names: others if Path(where) == place else (),
            )
        else:
            new.mkdir()
        for name, content in files.items():
            _write(new / name, content, like=place / name)


def _link(source: str, target: str) -> None:
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError:  # where it may not be linked
        shutil.copy2(source, target, follow_symlinks=False)


def _write(path: Path, content: bytes, like: Path) -> None:
    """Write a file to the disk, with the permissions of another where there is one."""
    with path.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    with suppress(FileNotFoundError):
        path.chmod(like.stat().st_mode & 0o777)
