"""Results of stages in files that may be lost: whole or not at all, the last used kept.

Each result is one file, named by its key, which begins with a digest of the rest: a damaged one is
as one that is not there. They are pickles. Arrays come back with their type, order and last bit;
one that is neither in C nor in Fortran order is not kept, since it would come back in another order
than it had, and sums depend on that.
"""

from __future__ import annotations

import hashlib
import io
import os
import pickle
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from files.atomic import temporary_directory_beside
from files.locks import LockedError, lock_or_refuse

#: Bytes that the stages of a store may take; another number of gigabytes by this variable.
LIMIT_BYTES = 4 * 2**30
LIMIT_GB = "SUNATLAS_STAGES_GB"
#: Share of the limit that is left when room is made, so that it is not made at each turn.
_LEFT = 0.9
#: Bytes that a process writes before it looks again how much there is.
_LOOKED_AFTER = 64 * 2**20
#: Digits of a key that name the folder: one folder lists a 256th of all.
_FOLDER = 2
_DIGEST_BYTES = 32


def limit_bytes() -> int:
    """Return the limit: $SUNATLAS_STAGES_GB, else `LIMIT_BYTES`; 0 keeps nothing.

    ValueError for a variable that is no number from 0 on.
    """
    text = os.environ.get(LIMIT_GB)
    if not text:
        return LIMIT_BYTES
    try:
        size = float(text)
    except ValueError:
        size = -1.0
    if not 0.0 <= size < float("inf"):
        raise ValueError(f"{LIMIT_GB} must be a number of gigabytes from 0 on; got {text!r}")
    return int(size * 2**30)


@dataclass(frozen=True)
class StageFiles:
    """Results by key in a directory that several processes may use.

    `limit`: bytes that all may take; 0 keeps nothing.
    """

    directory: Path
    limit: int
    _written: list[int] = field(default_factory=list, repr=False, compare=False)

    def get(self, key: str) -> Any:
        """Return a result; None where it is not kept, or damaged."""
        path = self._path(key)
        try:
            with path.open("rb") as file:
                stated = file.read(_DIGEST_BYTES)
                if hashlib.file_digest(file, "sha256").digest() != stated:
                    return None
                file.seek(_DIGEST_BYTES)
                found = _unpack(file)
        except Exception:  # noqa: BLE001 - of a class that is another by now: as if not there
            return None
        with suppress(OSError):
            os.utime(path)
        return found

    def put(self, key: str, value: Any) -> None:
        """Keep a result; nothing where that cannot be done."""
        path = self._path(key)
        if self.limit <= 0 or path.is_file():
            return
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with temporary_directory_beside(path) as scratch:
                made = scratch / path.name
                _write(made, value)
                size = made.stat().st_size
                if size > self.limit:
                    return
                made.replace(path)
        except (OSError, pickle.PicklingError, AttributeError, TypeError):
            return
        self._written.append(size)
        if sum(self._written) > min(_LOOKED_AFTER, self.limit // 16):
            self._written.clear()
            self.make_room()

    def keys(self) -> set[str]:
        """Return the keys of all that is kept."""
        return {path.parent.name + path.name for path in self._all()}

    def size(self) -> int:
        """Return the bytes that all files take."""
        return sum(path.stat().st_size for path in self._all())

    def make_room(self) -> None:
        """Remove what was used longest ago until the limit is kept; one process at a time."""
        with suppress(OSError, LockedError):
            found = {path: path.stat() for path in self._all()}
            total = sum(status.st_size for status in found.values())
            if total <= self.limit:
                return
            with lock_or_refuse(self.directory / "room"):
                for path in sorted(found, key=lambda one: found[one].st_mtime_ns):
                    path.unlink(missing_ok=True)
                    total -= found[path].st_size
                    if total <= _LEFT * self.limit:
                        return

    def _path(self, key: str) -> Path:
        return self.directory / key[:_FOLDER] / key[_FOLDER:]

    def _all(self) -> Iterator[Path]:
        """Yield the files of results: their names have no suffix."""
        return self.directory.glob(f"{'?' * _FOLDER}/[!.]*[!.]")


class _Pickler(pickle.Pickler):
    """Refuses arrays that would come back in another order."""

    def reducer_override(self, value: Any) -> Any:
        if isinstance(value, np.ndarray):
            flags = value.flags
            if not (flags.c_contiguous or flags.f_contiguous):
                raise pickle.PicklingError("an array in neither order")
        return NotImplemented


def _write(path: Path, value: Any) -> None:
    """Write a value's pickle, compressed on the way: data may be half of what memory there is."""
    from pyarrow import CompressedOutputStream  # noqa: PLC0415 - slow to load

    with path.open("wb") as file:
        file.write(bytes(_DIGEST_BYTES))
        with CompressedOutputStream(file, "zstd") as stream:
            _Pickler(stream, protocol=5).dump(value)
    with path.open("r+b") as file:
        file.seek(_DIGEST_BYTES)
        digest = hashlib.file_digest(file, "sha256").digest()
        file.seek(0)
        file.write(digest)


def _unpack(file: BinaryIO) -> Any:
    from pyarrow import CompressedInputStream  # noqa: PLC0415 - as above

    stream: Any = CompressedInputStream(file, "zstd")
    return pickle.load(io.BufferedReader(stream))  # noqa: S301 - our own, in a user's cache
