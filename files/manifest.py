"""What commands wrote: SHA-256 of a folder's files, so that a change by hand is named by its file.

The manifest is a list that `sha256sum --check` reads. A command that writes files takes them into
it (`write_recorded`), and no others. What the files are about to be is written before them, so
that what a kill leaves half done is not taken for a change by hand.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping
from contextlib import suppress
from pathlib import Path, PurePosixPath

from files.atomic import replace_all, replace_file
from files.checksums import CHECKSUMS, checksum_text, read_checksums
from files.problems import Problem
from files.reading import FileRefusedError, path_exists, read_bytes

FILE = CHECKSUMS
#: What the files are about to be; renamed to `FILE` after the last of them.
NEXT = f".{CHECKSUMS}.next"
BY_HAND = "the file is not as its command wrote it"


def read_manifest(folder: Path, name: str = FILE) -> dict[str, str] | None:
    """Return the digests of a folder's manifest by file; None where there is none.

    Raises
    ------
    FileRefusedError
        For what is no manifest.
    """
    try:
        return read_checksums(folder, name)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise FileRefusedError(folder / name, f"cannot be read: {error.strerror}") from error


def differences(folder: Path, names: Collection[str], *, required: bool = False) -> list[Problem]:
    """Say what of a folder is not as commands wrote it; an empty list where all is.

    Parameters
    ----------
    folder
        With a manifest.
    names
        Files that should be there, relative to the folder, POSIX.
    required
        Whether it is a problem that there is no manifest; else nothing is known and nothing said.
    """
    try:
        listed = read_manifest(folder)
    except FileRefusedError as error:
        return [Problem(FILE, error.line, None, error.reason)]
    if listed is None:
        return [Problem(FILE, None, None, "the file is missing")] if required else []
    coming = _coming(folder)
    found = []
    for name in sorted({*names, *listed}):
        expected = listed.get(name)
        try:
            digest = _digest(folder / name)
        except FileRefusedError as error:
            found.append(Problem(name, None, None, error.reason))
            continue
        if digest == expected and (digest is not None or name not in names):
            continue
        if coming is not None and digest == coming.get(name):
            continue  # a killed command had come this far
        said = "the file is missing" if digest is None else BY_HAND
        if expected is None and digest is not None:
            said = f"the file is not in {FILE}: no command wrote it"
        found.append(Problem(name, None, None, said))
    return found


def write_recorded(
    folder: Path,
    contents: Mapping[str, str | bytes | None],
    *,
    start: bool = False,
    together: str | None = None,
) -> bool:
    """Write files of a folder, each whole or not at all, and take them into its manifest.

    Parameters
    ----------
    folder
        Made where there is none.
    contents
        By name relative to the folder; None takes the file away.
    start
        Begin a manifest where there is none. Without it files beside which there is none are
        just written.
    together
        Sub-folder that all of them stand in, which is replaced as a whole: no kill leaves some of
        them new and others old.

    Returns
    -------
    bool
        Whether a file changed; the manifest is none of them.

    Raises
    ------
    FileRefusedError
        The manifest there is cannot be read; nothing has been written.
    OSError
        A file cannot be written.
    """
    listed, coming = read_manifest(folder), _coming(folder)
    recorded = listed is not None or start
    listed = listed or {}
    if coming is not None:  # what a killed command had dealt with stands
        done = {name for name in {*coming, *listed} if _digest(folder / name) == coming.get(name)}
        listed |= {name: coming.get(name, "") for name in done}
    encoded = {k: v.encode() if isinstance(v, str) else v for k, v in contents.items()}
    written = {
        k: hashlib.sha256(v).hexdigest() if v is not None else "" for k, v in encoded.items()
    }
    text = checksum_text({name: digest for name, digest in (listed | written).items() if digest})
    if recorded and not _is(folder / FILE, text):
        replace_file(folder / NEXT, text)
    if together is not None:
        changed = _replace_folder(folder / together, encoded)
    else:
        changed = False
        for name, data in encoded.items():
            if data is not None:
                changed |= replace_file(folder / name, data)
            elif path_exists(folder / name):
                (folder / name).unlink()
                changed = True
    if recorded:
        finish_interrupted_write(folder)
    return changed


def _replace_folder(old: Path, contents: Mapping[str, bytes | None]) -> bool:
    known = {path.name: path.read_bytes() for path in old.iterdir() if path.is_file()}
    coming = {PurePosixPath(file).name: data for file, data in contents.items()}
    wanted = {file: data for file, data in {**known, **coming}.items() if data is not None}
    if wanted == known:
        return False
    with replace_all(old) as (new,):
        new.mkdir()
        for file, data in wanted.items():
            (new / file).write_bytes(data)
    return True


def rewrite_manifest(folder: Path, names: Collection[str]) -> list[str]:
    """Take all the files of a folder as they are into its manifest; return those that were not.

    For a change by hand that is meant; whether the files are sound is for the caller to know.
    """
    known: dict[str, str] = {}
    with suppress(FileRefusedError):
        known = read_manifest(folder) or {}
    listed = {name: hashlib.sha256(read_bytes(folder / name)).hexdigest() for name in names}
    replace_file(folder / FILE, checksum_text(listed))
    (folder / NEXT).unlink(missing_ok=True)
    return sorted(name for name in {*listed, *known} if listed.get(name) != known.get(name))


def manifest_digest(folder: Path) -> str | None:
    """Return the SHA-256 of a folder's manifest, which names all that is in it; None without."""
    return _digest(folder / FILE)


def finish_interrupted_write(folder: Path) -> None:
    """Finish what a killed command left: the coming manifest is the manifest if the files are so.

    Where the files are still those of the manifest there is, the coming one is dropped. Where they
    are some of both, both stay: the command is to be run again.
    """
    if (coming := _coming(folder)) is None:
        return
    listed = read_manifest(folder) or {}
    names = {*coming, *listed}
    present = {name: _digest(folder / name) for name in names}
    if all(present[name] == coming.get(name) for name in names):
        (folder / NEXT).replace(folder / FILE)
    elif all(present[name] == listed.get(name) for name in names):
        (folder / NEXT).unlink()


def _coming(folder: Path) -> dict[str, str] | None:
    """Return what files are about to be; None where nothing is written, or that is damaged."""
    try:
        return read_manifest(folder, NEXT)
    except FileRefusedError:
        return None


def _is(path: Path, text: str) -> bool:
    return path.is_file() and path.read_bytes() == text.encode()


def _digest(path: Path) -> str | None:
    """Return the SHA-256 of a file; None where there is none."""
    try:
        return hashlib.sha256(read_bytes(path)).hexdigest()
    except FileNotFoundError:
        return None
