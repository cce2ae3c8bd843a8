"""Results of stages in files that may be lost: compact, whole or not at all, the dearest kept.

Each result is one file, named by its key, what it cost to make and its digest, by which a damaged
one is as one that is not there. They are pickles, as those of joblib.Memory (which lets go of what
was used longest ago, whatever it cost, and keys by arguments). Arrays come back with their type,
order and last bit; one that is neither in C nor in Fortran order is not kept, since it would come
back in another order than it had, and sums depend on that.
"""

from __future__ import annotations

import io
import math
import os
import pickle
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from files.atomic import temporary_directory_beside
from files.checksums import sha256
from files.locks import LockedError, lock_or_refuse

#: Bytes that the stages of a store may take; another number of gigabytes by this variable.
LIMIT_BYTES = 4 * 2**30
LIMIT_GB = "SUNATLAS_STAGES_GB"
#: After how long without use a result is worth half.
_HALF_LIFE_S = 7 * 86400.0
#: Share of the limit that is left when room is made, so that it is not made at each turn.
_LEFT = 0.9
#: Bytes that a process writes before it looks again how much there is.
_LOOKED_AFTER = 64 * 2**20
#: Digits of a key that name the folder: one folder lists a 256th of all.
_FOLDER = 2


def limit_bytes() -> int:
    """Return the limit: $SUNATLAS_STAGES_GB, else `LIMIT_BYTES`; 0 keeps nothing.

    Raises
    ------
    ValueError
        For a variable that is no number from 0 on.
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

    Attributes
    ----------
    directory
        Made at the first result.
    limit
        Bytes that all may take; 0 keeps nothing.
    """

    directory: Path
    limit: int

    def get(self, key: str) -> Any:
        """Return a result; None where it is not kept, or damaged."""
        path = self._find(key)
        try:
            if path is None or sha256(path) != path.suffix[1:]:
                return None
            with path.open("rb") as file:
                found = _unpack(file)
        except Exception:  # noqa: BLE001 - of a class that is another by now: as if not there
            return None
        with suppress(OSError):
            os.utime(path)
        return found

    def has(self, key: str) -> bool:
        """Say whether a result is kept, damaged or not."""
        return self._find(key) is not None

    def put(self, key: str, value: Any, seconds: float) -> None:
        """Keep a result that took so long to make; nothing where that cannot be done."""
        if self.limit <= 0 or self.has(key):
            return
        path = self._folder(key) / f"{key[_FOLDER:]}.{round(1000 * seconds)}"
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with temporary_directory_beside(path) as scratch:
                made = scratch / path.name
                with made.open("wb") as file:
                    _pack(value, file)
                path = made.replace(path.with_name(f"{path.name}.{sha256(made)}"))
            size = path.stat().st_size
        except (OSError, pickle.PicklingError, AttributeError, TypeError):
            return
        if size > self.limit:
            path.unlink(missing_ok=True)
            return
        self._written.append(size)
        if sum(self._written) > min(_LOOKED_AFTER, self.limit // 16):
            self._written.clear()
            self.make_room()

    def keys(self) -> set[str]:
        """Return the keys of all that is kept."""
        return set(self.costs())

    def costs(self) -> dict[str, float]:
        """Return the seconds that each result took to make, by key."""
        return {
            entry.path.parent.name + entry.path.name.partition(".")[0]: entry.cost_ms / 1000.0
            for entry in self._all()
        }

    def size(self) -> int:
        """Return the bytes that all files take."""
        return sum(entry.size for entry in self._all())

    def make_room(self) -> None:
        """Remove what is worth least a byte until the limit is kept; one process does so at a time.

        A result is worth what it cost, half of that after each week without use.
        """
        entries = list(self._all())
        total = sum(entry.size for entry in entries)
        if total <= self.limit:
            return
        with suppress(OSError, LockedError), lock_or_refuse(self.directory / "room"):
            now = time.time()
            for entry in sorted(entries, key=lambda one: one.worth(now)):
                entry.path.unlink(missing_ok=True)
                total -= entry.size
                if total <= _LEFT * self.limit:
                    return

    @cached_property
    def _written(self) -> list[int]:
        return []

    def _folder(self, key: str) -> Path:
        return self.directory / key[:_FOLDER]

    def _find(self, key: str) -> Path | None:
        folder, start = self._folder(key), f"{key[_FOLDER:]}."
        with suppress(OSError):
            for name in os.listdir(folder):  # noqa: PTH208 - names are wanted
                if name.startswith(start) and name.count(".") == 2:
                    return folder / name
        return None

    def _all(self) -> Iterator[_Entry]:
        with suppress(OSError):
            for folder in os.scandir(self.directory):
                if folder.is_dir() and len(folder.name) == _FOLDER:
                    for entry in os.scandir(folder.path):
                        if not entry.name.startswith("."):
                            with suppress(OSError, ValueError, IndexError):
                                status = entry.stat()
                                cost = int(entry.name.split(".")[1])
                                yield _Entry(
                                    Path(entry.path), status.st_size, cost, status.st_mtime
                                )


@dataclass(frozen=True)
class _Entry:
    path: Path
    size: int
    cost_ms: int
    used: float

    def worth(self, now: float) -> float:
        """Milliseconds a byte, less the longer it was not used."""
        halved = max(now - self.used, 0.0) / _HALF_LIFE_S
        return self.cost_ms / self.size * math.exp2(-halved)


class _Pickler(pickle.Pickler):
    """Refuses arrays that would come back in another order."""

    def reducer_override(self, value: Any) -> Any:
        if isinstance(value, np.ndarray):
            flags = value.flags
            if not (flags.c_contiguous or flags.f_contiguous):
                raise pickle.PicklingError("an array in neither order")
        return NotImplemented


def _pack(value: Any, file: BinaryIO) -> None:
    """Write a value's pickle, compressed on the way: data may be half of what memory there is."""
    from pyarrow import CompressedOutputStream  # noqa: PLC0415 - slow to load

    with CompressedOutputStream(file, "zstd") as stream:
        _Pickler(stream, protocol=5).dump(value)


def _unpack(file: BinaryIO) -> Any:
    from pyarrow import CompressedInputStream  # noqa: PLC0415 - as above

    stream: Any = CompressedInputStream(file, "zstd")
    return pickle.load(io.BufferedReader(stream))  # noqa: S301 - our own, in a user's cache
