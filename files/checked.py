"""Files that can be lost: written in one step, and read only where they are as they were written.

Unlike `files.atomic` nothing is forced to the disk: after a power cut a file may be damaged, which
its digest shows.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from files.temporary import temporary_file_beside

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

_DIGEST_BYTES = hashlib.sha256().digest_size


class CheckedFile(io.RawIOBase):
    """A file that is written once from front to back, of which a digest is taken meanwhile."""

    def __init__(self, file: BinaryIO) -> None:
        super().__init__()
        self._file = file
        self._digest = hashlib.sha256()
        file.write(bytes(_DIGEST_BYTES))

    def writable(self) -> bool:
        """Say that it can be written to."""
        return True

    def write(self, part: ReadableBuffer) -> int:
        """Write some bytes; returns how many."""
        self._digest.update(part)
        return self._file.write(part)

    def finish(self) -> None:
        """Put the digest to the front."""
        self._file.seek(0)
        self._file.write(self._digest.digest())


@contextmanager
def writing_checked(path: Path) -> Iterator[CheckedFile]:
    """Yield a file to write to, behind its digest; directories above it are made.

    It stands once all is written. Of processes that write the same file, the last one's stands.

    Raises
    ------
    OSError
        Where it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with temporary_file_beside(path) as scratch:
        with scratch.open("wb") as file:
            checked = CheckedFile(file)
            yield checked
            checked.finish()
        scratch.replace(path)


@contextmanager
def reading_checked(path: Path) -> Iterator[BinaryIO | None]:
    """Yield a file that was written so, to be read from front to back behind its digest.

    None where there is no such file, or a damaged one. It is never in memory as a whole.
    """
    try:
        file = path.open("rb")
    except OSError:
        yield None
        return
    with file:
        written = file.read(_DIGEST_BYTES)
        whole = hashlib.file_digest(file, "sha256").digest() == written
        file.seek(_DIGEST_BYTES)
        yield file if whole else None
