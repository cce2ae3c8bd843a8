"""Files that can be lost: written in one step, and read only where they are as they were written.

Unlike `files.atomic` nothing is forced to the disk: after a power cut a file may be damaged, which
its digest shows.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from files.temporary import temporary_file_beside

_DIGEST_BYTES = hashlib.sha256().digest_size


def write_checked(path: Path, *parts: bytes | memoryview) -> None:
    """Write parts one after the other, behind their digest; directories above the file are made.

    Of processes that write the same file, the last one's stands.

    Raises
    ------
    OSError
        Where it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with temporary_file_beside(path) as scratch:
        digest = hashlib.sha256()
        for part in parts:
            digest.update(part)
        with scratch.open("wb") as file:
            file.write(digest.digest())
            file.writelines(parts)
        scratch.replace(path)


def read_checked(path: Path) -> memoryview | None:
    """Return what `write_checked` wrote; None where there is no such file, or a damaged one."""
    try:
        held = path.read_bytes()
    except OSError:
        return None
    content = memoryview(held)[_DIGEST_BYTES:]
    if hashlib.sha256(content).digest() != held[:_DIGEST_BYTES]:
        return None
    return content
