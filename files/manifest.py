"""What commands wrote: a folder's list of checksums, so that a change by hand is named by its file.

A command that writes files takes them into the list, and no others. The list that is to come is
written before them, so that what a kill leaves half done is not taken for a change by hand.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Collection, Mapping
from contextlib import suppress
from pathlib import Path, PurePosixPath

from files import checksums
from files.atomic import replace_file, replace_in_directory
from files.checksums import checksum_text, read_checksums, sha256
from files.reading import FileRefusedError

FILE = checksums.CHECKSUMS
#: The list that is to come; renamed to `FILE` after the last of its files.
NEXT = f".{FILE}.next"


def differences(
    folder: Path, names: Collection[str], *, required: bool = False
) -> list[tuple[str, str]]:
    """Name what of a folder is not as commands wrote it, and why; an empty list where all is.

    `names` should be there, relative and POSIX. Without a list nothing is said, unless `required`.
    """
    try:
        return checksums.differences(folder, names, _coming(folder))
    except FileNotFoundError:
        return [(FILE, "missing")] if required else []
    except FileRefusedError as error:
        return [(FILE, str(error).removeprefix(f"{folder / FILE}").lstrip(":, "))]


def write_recorded(
    folder: Path,
    contents: Mapping[str, str | bytes | None],
    *,
    start: bool = False,
    together: str | None = None,
) -> bool:
    """Write files of a folder, each whole or not at all, and take them into its list.

    Contents stand by name relative to the folder; None takes a file away. Where there is no list
    one is begun if `start`, else files are just written. Files of a sub-folder that change
    `together` do so in one step. Returns whether a file changed, the list aside. FileRefusedError
    where the list cannot be read, and nothing has been written; OSError where a file cannot be.
    """
    listed = _settled(folder)
    changed: dict[str, bytes | None] = {}
    digests = dict(listed or {})
    for name, content in contents.items():
        data = content.encode() if isinstance(content, str) else content
        digests.pop(name, None)
        if data is not None:
            digests[name] = hashlib.sha256(data).hexdigest()
        if _digest(folder / name) != digests.get(name):
            changed[name] = data
    recorded = listed is not None or start
    if recorded and digests != _listed(folder):
        replace_file(folder / NEXT, checksum_text(digests))
    if together is not None and changed:
        inner = {PurePosixPath(name).name: data for name, data in changed.items()}
        new = {name: data for name, data in inner.items() if data is not None}
        replace_in_directory(folder / together, new, gone=inner)
    else:
        for name, data in changed.items():
            if data is None:
                (folder / name).unlink()
            else:
                replace_file(folder / name, data)
    if recorded:
        finish_interrupted_write(folder)
    return bool(changed)


def rewrite_manifest(folder: Path, names: Collection[str]) -> list[str]:
    """Take all the files of a folder as they are into its list; return those that were not.

    For a change by hand that is meant; whether the files are sound is for the caller to know.
    """
    known: dict[str, str] | None = None
    with suppress(FileRefusedError):
        known = _listed(folder)
    listed = {name: sha256(folder / name) for name in names}
    replace_file(folder / FILE, checksum_text(listed))
    (folder / NEXT).unlink(missing_ok=True)
    return sorted({name for name, _ in {*listed.items()} ^ {*(known or {}).items()}})


def manifest_digest(folder: Path) -> str | None:
    """Return the SHA-256 of a folder's list, which names all that is in it; None without."""
    return _digest(folder / FILE)


def finish_interrupted_write(folder: Path) -> None:
    """Let the coming list take its place if a killed command had written all of its files.

    Where it had written none, the coming list is dropped. Where some, both stay: the command is to
    be run again.
    """
    coming, settled = _coming(folder), _settled(folder)
    if coming is not None and settled == coming:
        (folder / NEXT).replace(folder / FILE)
    elif coming is not None and settled == _listed(folder):
        (folder / NEXT).unlink()


def is_unfinished(folder: Path) -> bool:
    """Say whether a killed command left some files new and others old."""
    return os.path.lexists(folder / NEXT)


def _settled(folder: Path) -> dict[str, str] | None:
    """Return the list, with the files that a killed command had dealt with; None without a list."""
    listed, coming = _listed(folder), _coming(folder)
    if coming is None:
        return listed
    listed = listed or {}
    done = {name for name in {*listed, *coming} if _digest(folder / name) == coming.get(name)}
    kept = {name: digest for name, digest in listed.items() if name not in done}
    return kept | {name: coming[name] for name in done & coming.keys()}


def _listed(folder: Path) -> dict[str, str] | None:
    return read_checksums(folder) if os.path.lexists(folder / FILE) else None


def _coming(folder: Path) -> dict[str, str] | None:
    """Return the list that is to come; None where nothing is being written, or it is damaged."""
    with suppress(FileRefusedError, FileNotFoundError):
        return read_checksums(folder, NEXT)
    return None


def _digest(path: Path) -> str | None:
    return sha256(path) if path.is_file() else None
