"""Sets of files that take their place in a directory all at once.

A reader, and who comes after a kill, finds every file of the set before or every file of the new
one: the directory is made anew beside its place, with the other files that it holds as hard links,
and both directories change places in one step.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Collection, Mapping
from contextlib import suppress
from pathlib import Path

from files.atomic import name_file_in_errors
from files.exchange import exchange
from files.locks import wait_for_lock
from files.temporary import temporary_directory_beside

#: Other entries, of all depths, that a directory may hold: each is linked.
MOST_OTHERS = 10_000


class UnreplaceableDirectoryError(ValueError):
    """A directory that cannot be replaced as a whole; the message says why and what could be."""


def require_replaceable_directory(directory: Path) -> None:
    """Refuse a directory that cannot change places with another, before anything is made for it.

    Raises
    ------
    UnreplaceableDirectoryError
        If it is a file, the root of a file system, the current directory or one above it, or
        holds too many other files.
    """
    try:
        place = directory.resolve()
    except (OSError, RuntimeError) as error:  # a loop of symbolic links
        raise UnreplaceableDirectoryError(f"{directory}: expected a directory ({error})") from None
    if place.is_dir() or not os.path.lexists(place):
        held = "the root of a file system" if place.is_mount() or not place.name else ""
        if Path.cwd().is_relative_to(place):
            held = "the current directory" if place == Path.cwd() else "above the current one"
        if held:
            raise UnreplaceableDirectoryError(
                f"{directory}: expected a directory that can be replaced as a whole; this is "
                f"{held}. Name one in it, such as {directory / 'calibration'}"
            )
        if _holds_more_than(place, MOST_OTHERS):
            raise UnreplaceableDirectoryError(
                f"{directory}: expected a directory of at most {MOST_OTHERS} files; name a new one"
            )
        return
    raise UnreplaceableDirectoryError(f"{directory}: expected a directory; this is a file")


def replace_in_directory(
    directory: Path, files: Mapping[str, bytes], gone: Collection[str] = ()
) -> None:
    """Put files into a directory, all of them or none; other files there stay.

    On return they survive a power cut. Where the file system cannot exchange two directories, the
    old one leaves before the new one comes: a kill between the two leaves none, never a mixture.

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
    UnreplaceableDirectoryError
        As `require_replaceable_directory`.
    OSError
        Where it cannot be written; the directory is as it was.
    """
    require_replaceable_directory(directory)
    place = directory.resolve()
    place.parent.mkdir(parents=True, exist_ok=True)
    with (
        name_file_in_errors(place),
        wait_for_lock(place),
        temporary_directory_beside(place) as scratch,
    ):
        new = scratch / "new"
        new.mkdir()
        kept = _keep(place, new, {*files, *gone})
        for name, content in files.items():
            _write(new / name, content, like=place / name)
        _sync(new)
        if not os.path.lexists(place):
            new.rename(place)
        elif exchange(new, place):
            _rescue(new, place, {*files, *gone, *kept})
        else:
            place.rename(scratch / "old")
            new.rename(place)
            _rescue(scratch / "old", place, {*files, *gone, *kept})
        _sync(place.parent)


def _keep(place: Path, new: Path, but: Collection[str]) -> list[str]:
    """Link what a directory holds into another; returns the names."""
    if not place.is_dir():
        return []
    new.chmod(place.stat().st_mode & 0o7777)
    names = [entry.name for entry in place.iterdir() if entry.name not in but]
    for name in names:
        entry = place / name
        if entry.is_dir() and not entry.is_symlink():
            shutil.copytree(entry, new / name, symlinks=True, copy_function=_link)
        else:
            _link(entry, new / name)
    return names


def _link(source: str | Path, target: str | Path) -> None:
    """Link a file, or copy it where it may not be linked."""
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError:
        shutil.copy2(source, target, follow_symlinks=False)


def _rescue(old: Path, place: Path, known: Collection[str]) -> None:
    """Move what came into the old directory while the new one was made."""
    for entry in old.iterdir():
        if entry.name not in known:
            with suppress(OSError):
                entry.rename(place / entry.name)


def _write(path: Path, content: bytes, like: Path) -> None:
    with path.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    if like.is_file():
        path.chmod(like.stat().st_mode & 0o777)


def _sync(directory: Path) -> None:
    """Let names in a directory survive a power cut, where the system can."""
    if os.name == "posix":
        handle = os.open(directory, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _holds_more_than(place: Path, most: int) -> bool:
    count = 0
    for _, directories, files in os.walk(place):
        count += len(directories) + len(files)
        if count > most:
            return True
    return False
