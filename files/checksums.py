"""SHA-256 of every file of a directory, in the format `sha256sum --check` reads."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath

from files.reading import FileRefusedError, read_text

CHECKSUMS = "checksums-sha256.txt"
_LINE = re.compile(r"([0-9a-f]{64}) [ *](.+)")


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
    """Read the checksum of each file, as listed; FileNotFoundError where there is no list.

    FileRefusedError on a line that is no checksum with a path inside the directory, or names a file
    twice.
    """
    path = directory / name
    listed: dict[str, str] = {}
    for number, line in enumerate(read_text(path).splitlines(), start=1):
        found = _LINE.fullmatch(line)
        file = PurePosixPath(found[2] if found else "/")
        if found is None or file.is_absolute() or ".." in file.parts:
            raise FileRefusedError(
                path,
                "expected 64 hexadecimal digits, two spaces and a path inside the directory; got "
                f"{line[:120]!r}",
                number,
            )
        if found[2] in listed:
            raise FileRefusedError(path, f"{found[2]} is listed twice", number)
        listed[found[2]] = found[1]
    return listed


def differences(
    directory: Path, names: Iterable[str] | None = None, coming: Mapping[str, str] | None = None
) -> list[tuple[str, str]]:
    """Find what does not hold: (file, what is wrong with it), sorted; empty where all holds.

    `names` should be listed, by default all files there are; by `coming`, another list, a file may
    be as well. Raises as `read_checksums`.
    """
    listed = read_checksums(directory)
    present = set(contents(directory) if names is None else names) - {CHECKSUMS}
    wrong = []
    for name in sorted(present | listed.keys()):
        path, found = directory / name, None
        if path.is_symlink() or (path.exists() and not path.is_file()):
            wrong.append((name, "not a regular file"))
            continue
        if path.is_file():
            found = sha256(path)
        if (found or name not in present) and (
            found == listed.get(name) or (coming is not None and found == coming.get(name))
        ):
            continue
        if found is None:
            wrong.append((name, "listed but missing" if name in listed else "missing"))
        elif name not in listed:
            wrong.append((name, "not listed"))
        else:
            wrong.append((name, f"SHA-256 is {found}, listed {listed[name]}"))
    return wrong
