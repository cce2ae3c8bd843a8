"""SHA-256 of every file of a directory, in the format `sha256sum --check` reads."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from files.reading import FileRefusedError

CHECKSUMS = "checksums-sha256.txt"
_LINE = re.compile(r"([0-9a-f]{64}) [ *](.+)")


class ChecksumFileError(FileRefusedError):
    """The list of checksums cannot be read; the message names file and line."""


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def contents(directory: Path) -> list[str]:
    """List the paths of the files under a directory, relative, POSIX, sorted."""
    return sorted(
        path.relative_to(directory).as_posix()
        for path in directory.rglob("*")
        if path.is_symlink() or not path.is_dir()
    )


def checksum_text(digests: Mapping[str, str]) -> str:
    """Return the text of a list of checksums, sorted by file."""
    return "".join(f"{digests[name]}  {name}\n" for name in sorted(digests))


def write_checksums(directory: Path) -> None:
    """List every file under a directory with its checksum, the list itself left out."""
    names = (name for name in contents(directory) if name != CHECKSUMS)
    text = checksum_text({name: sha256(directory / name) for name in names})
    (directory / CHECKSUMS).write_text(text, "utf-8", newline="\n")


def read_checksums(directory: Path, name: str = CHECKSUMS) -> dict[str, str]:
    """Read the checksum of each file, as listed.

    Raises
    ------
    FileNotFoundError
        Where there is no list.
    ChecksumFileError
        On a line that is no checksum with a path inside the directory, or names a file twice.
    """
    path = directory / name
    listed: dict[str, str] = {}
    for number, line in enumerate(path.read_text("utf-8", "replace").splitlines(), start=1):
        found = _LINE.fullmatch(line)
        file = found[2] if found else ""
        pure = PurePosixPath(file)
        if found is None or pure.is_absolute() or ".." in pure.parts:
            raise ChecksumFileError(
                path,
                "expected 64 hexadecimal digits, two spaces and a path inside the directory; got "
                f"{line[:120]!r}",
                number,
            )
        if file in listed:
            raise ChecksumFileError(path, f"{file} is listed twice", number)
        listed[file] = found[1]
    return listed


def differences(directory: Path) -> list[tuple[str, str]]:
    """Find what does not hold: (file, what is wrong with it), sorted; empty where all holds.

    Raises as `read_checksums`.
    """
    listed = read_checksums(directory)
    present = set(contents(directory)) - {CHECKSUMS}
    wrong = [(name, "listed but missing") for name in listed.keys() - present]
    wrong += [(name, "not listed") for name in present - listed.keys()]
    for name in listed.keys() & present:
        path = directory / name
        if path.is_symlink() or not path.is_file():
            wrong.append((name, "not a regular file"))
        elif (found := sha256(path)) != listed[name]:
            wrong.append((name, f"SHA-256 is {found}, listed {listed[name]}"))
    return sorted(wrong)
