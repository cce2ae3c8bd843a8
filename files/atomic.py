"""Writing files and directories whole or not at all.

Everything is made beside its place and put into it in one step: who reads meanwhile sees the
earlier content or the new one, never neither, and a process that is killed leaves no half of
either. What it was making is removed by the next that writes there (`files.temporary`).
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from files.exchange import exchange
from files.locks import wait_for_lock
from files.temporary import remove_stale_files, temporary_directory_beside, temporary_file_beside


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
        remove_stale_files(path.parent, path.name)
        return False
    path.parent.mkdir(parents=True, exist_ok=True)
    with name_file_in_errors(path), temporary_file_beside(path) as scratch:
        with scratch.open("wb") as file:
            file.write(wanted)
            file.flush()
            os.fsync(file.fileno())
        if known:
            scratch.chmod(path.stat().st_mode & 0o777)
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

    Each takes its place in one step (`files.exchange`); of several, a kill may leave the
    first ones new and the last ones old, each whole. Where the file system cannot exchange two
    directories, an earlier directory stays where it is and its files are replaced one at a time:
    a kill may then leave new files among old ones, which checksums tell and the next run mends.

    An error in the block leaves the targets as they are, and so does one in putting the new ones
    in place: what had been there is put back. Another process that replaces the first target
    waits (`files.locks`).

    Parameters
    ----------
    targets
        Paths in one directory, which is made where it is not there, and goes again after an
        error; what each holds is replaced.

    Yields
    ------
    tuple of Path
        For each target the path to make it at.

    Raises
    ------
    FileSystemRootError
        Where a target is the root of a file system.
    OSError
        Where it cannot be written; one that names no file, as of a full disk, names the first
        target, and one of a file being made its place.
    """
    for target in targets:
        require_replaceable(target)
    # Beside the targets: a rename is only atomic within a file system.
    first = targets[0]
    with (
        name_file_in_errors(first),
        _made_parents(first),
        wait_for_lock(first),
        temporary_directory_beside(first) as scratch,
    ):
        made, before = scratch / "made", scratch / "before"
        made.mkdir()
        before.mkdir()
        new = tuple(made / target.name for target in targets)
        try:
            yield new
        except OSError as error:
            if isinstance(error.filename, str) and Path(error.filename).is_relative_to(made):
                error.filename = str(first.parent / Path(error.filename).relative_to(made))
            raise
        with ExitStack() as undo:
            for path, target in zip(new, targets, strict=True):
                _put(path, target, before / target.name, undo)
            undo.pop_all()


class FileSystemRootError(ValueError):
    """A path is the root of a file system, which cannot be replaced."""


def require_replaceable(path: Path) -> None:
    """Refuse a path that cannot be replaced, before anything is made for it.

    Raises
    ------
    FileSystemRootError
        Where it is the root of a file system: `/`, a drive, or where one is mounted.
    """
    if not path.name or (path.is_mount() and not path.is_symlink()):
        raise FileSystemRootError(
            f"{path}: the root of a file system cannot be replaced; expected a directory in it; "
            "nothing was written"
        )


@contextmanager
def _made_parents(path: Path) -> Iterator[None]:
    """Make the directories above a path; after an error those that were made go again."""
    missing = [parent for parent in path.parents if not parent.exists()]
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        yield
    except BaseException:
        with suppress(OSError):  # somebody else has put something there
            for parent in missing:
                parent.rmdir()
        raise


def _put(path: Path, target: Path, before: Path, undo: ExitStack) -> None:
    """Put what was made into its place."""
    if not os.path.lexists(target):
        path.rename(target)
        undo.callback(target.rename, path)
    elif exchange(path, target):
        undo.callback(exchange, path, target)
    elif _is_directory(path) and _is_directory(target):
        _put_within(path, target, before, undo)
    else:
        _put_file(path, target, before, undo)


def _put_within(made: Path, target: Path, before: Path, undo: ExitStack) -> None:
    """Give a directory the content of another, an entry at a time."""
    before.mkdir()
    wanted = {path.name: path for path in made.iterdir()}
    for name in sorted(wanted):
        path, place = wanted[name], target / name
        if not os.path.lexists(place):
            path.rename(place)
            undo.callback(place.rename, path)
        elif _is_directory(path) and _is_directory(place):
            _put_within(path, place, before / name, undo)
        else:
            _put_file(path, place, before / name, undo)
    for place in sorted(target.iterdir()):
        if place.name not in wanted:
            place.rename(before / place.name)
            undo.callback((before / place.name).rename, place)


def _put_file(path: Path, place: Path, before: Path, undo: ExitStack) -> None:
    """Put a file over another, which stays in reach; only a directory has to leave first."""
    if _is_directory(path) or _is_directory(place):
        place.rename(before)
        undo.callback(before.rename, place)
        path.rename(place)
        undo.callback(place.rename, path)
        return
    os.link(place, before, follow_symlinks=False)
    path.replace(place)
    undo.callback(before.replace, place)


def _is_directory(path: Path) -> bool:
    return path.is_dir() and not path.is_symlink()
