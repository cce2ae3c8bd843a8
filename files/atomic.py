"""Writing files and directories whole or not at all.

Everything is made beside its place and renamed into it: who reads meanwhile sees the earlier
content or the new one, and a process that is killed leaves no half of either.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import sys
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from files.locks import wait_for_lock
from files.temporary import temporary_directory_beside, temporary_file_beside

#: Entries, of all depths, that a directory may hold whose files are replaced at once.
MOST_OTHERS = 10_000


class UnreplaceableError(ValueError):
    """A path that cannot be replaced as a whole; the message says why and what could be."""


def replace_file(path: Path, content: str | bytes) -> bool:
    """Write a file whole or not at all; on return it survives a power cut.

    Directories above it are made. An earlier file keeps its permissions, a new one has those that
    the umask leaves.

    Parameters
    ----------
    path
        Of the file.
    content
        Text is written as UTF-8, its line ends as they are.

    Returns
    -------
    bool
        Whether the content changed; a file that holds it already is not written.

    Raises
    ------
    OSError
        Where it cannot be written; names the file.
    """
    wanted = content.encode() if isinstance(content, str) else content
    known = path.is_file()
    if known and path.read_bytes() == wanted:
        return False
    path.parent.mkdir(parents=True, exist_ok=True)
    with name_file_in_errors(path), temporary_file_beside(path) as scratch:
        _write(scratch, wanted, like=path)
        scratch.replace(path)
    return True


@contextmanager
def name_file_in_errors(path: Path) -> Iterator[None]:
    """Let errors of the file system that name no file, as of a full disk, name this one."""
    try:
        yield
    except OSError as error:
        if error.errno is None or error.filename is not None:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


@contextmanager
def replace_all(*targets: Path) -> Iterator[tuple[Path, ...]]:
    """Make files and directories elsewhere; they take their places when the block ends.

    A directory changes places with the earlier one, on Linux at once. Elsewhere the earlier one is
    moved aside for that (`.<name>.before`): a kill in this moment leaves it there, and the next
    call puts it back first. An error in the block leaves the targets as
    they are. Another process that replaces the first target waits (`files.locks`).

    Parameters
    ----------
    targets
        Paths in one directory, which is made where it is not there; what each holds is replaced.

    Yields
    ------
    tuple of Path
        For each target the path to make it at.

    Raises
    ------
    UnreplaceableError
        Where a target is the root of a file system.
    OSError
        Where it cannot be written; one that names no file, as of a full disk, names the first
        target, and one of a file being made its place.
    """
    for target in targets:
        require_replaceable(target)
    first = targets[0]
    first.parent.mkdir(parents=True, exist_ok=True)
    with (
        name_file_in_errors(first),
        wait_for_lock(first),
        temporary_directory_beside(first) as scratch,
    ):
        for target in targets:
            restore(target)
        new = tuple(scratch / target.name for target in targets)
        try:
            yield new
        except OSError as error:
            if isinstance(error.filename, str) and Path(error.filename).is_relative_to(scratch):
                error.filename = str(first.parent / Path(error.filename).relative_to(scratch))
            raise
        for path, target in zip(new, targets, strict=True):
            _put(path, target)


def _before(target: Path) -> Path:
    return target.with_name(f".{target.name}.before")


def restore(target: Path) -> None:
    """Put back what a killed process had moved aside; remove it if something is there again."""
    before = _before(target)
    if os.path.lexists(before) and not os.path.lexists(target):
        before.rename(target)
    shutil.rmtree(before, ignore_errors=True)


def _put(path: Path, target: Path) -> None:
    """Put what was made into its place."""
    if not target.is_dir() or target.is_symlink():
        path.replace(target)
        return
    if _exchange(path, target):  # the earlier one goes with what it was made in
        return
    before = _before(target)
    target.rename(before)
    try:
        path.rename(target)
    except OSError:
        before.rename(target)
        raise
    shutil.rmtree(before, ignore_errors=True)


def _exchange(one: Path, other: Path) -> bool:
    """Let two paths change places at once; False where the system or its file system cannot."""
    if sys.platform != "linux":
        return False
    here, exchange = -100, 2  # AT_FDCWD, RENAME_EXCHANGE
    renameat2 = getattr(ctypes.CDLL(None), "renameat2", None)
    done = renameat2 and renameat2(here, os.fsencode(one), here, os.fsencode(other), exchange)
    return done == 0


def require_replaceable(path: Path) -> None:
    """Refuse a path that cannot be replaced, before anything is made for it.

    Raises
    ------
    UnreplaceableError
        Where it is the root of a file system: `/`, a drive, or where one is mounted.
    """
    if not path.name or (path.is_mount() and not path.is_symlink()):
        raise UnreplaceableError(
            f"{path}: the root of a file system cannot be replaced; expected a directory in it; "
            "nothing was written"
        )


def require_replaceable_directory(directory: Path) -> None:
    """Refuse a directory whose files cannot be replaced at once, before anything is made for it.

    Raises
    ------
    UnreplaceableError
        If it is a file, the root of a file system, the current directory or one above it, or
        holds too many other files.
    """
    try:
        place = directory.resolve()
        require_replaceable(place)
    except (OSError, RuntimeError) as error:  # a loop of symbolic links
        raise UnreplaceableError(f"{directory}: expected a directory ({error})") from None
    if os.path.lexists(place) and not place.is_dir():
        raise UnreplaceableError(f"{directory}: expected a directory; this is a file")
    if Path.cwd().is_relative_to(place):
        held = "the current directory" if place == Path.cwd() else "above the current one"
        raise UnreplaceableError(
            f"{directory}: expected a directory that can be replaced as a whole; this is {held}. "
            f"Name one in it, such as {directory / 'calibration'}"
        )
    if sum(len(inner) + len(files) for _, inner, files in os.walk(place)) > MOST_OTHERS:
        raise UnreplaceableError(
            f"{directory}: expected a directory of at most {MOST_OTHERS} files; name a new one"
        )


def replace_in_directory(
    directory: Path, files: Mapping[str, bytes], gone: Collection[str] = ()
) -> None:
    """Put files into a directory, all of them or none; other files there stay.

    Parameters
    ----------
    directory
        That is made where it is not there, with those above it.
    files
        Content by name.
    gone
        Names that are not there afterwards.

    Raises
    ------
    UnreplaceableError
        As `require_replaceable_directory`.
    OSError
        Where it cannot be written; the directory is as it was.
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
    """Link a file, or copy it where it may not be linked."""
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError:
        shutil.copy2(source, target, follow_symlinks=False)


def _write(path: Path, content: bytes, like: Path) -> None:
    """Write a file to the disk, with the permissions of another where there is one."""
    with path.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    with suppress(FileNotFoundError):
        path.chmod(like.stat().st_mode & 0o777)
