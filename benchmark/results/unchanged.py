"""Answers that hold until a file changes: nothing is computed to say that there is nothing to do.

An answer is kept in the user's cache directory with a fingerprint of all that it depends on: path,
size and time of the last change of every source file and table of ours and of every file of the
records it is about, and the versions of what is installed. One that is damaged or of another
fingerprint is not there.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any

from files.checked import read_checked, write_checked
from files.user_cache import user_cache

_ROOT = Path(__file__).resolve().parents[2]
_PACKAGES = ("files", "survey_data", "algorithms", "registry", "calibrate", "benchmark", "api")
_INSTALLED = ("numpy", "scipy", "numba", "pandas")
#: Folders whose files say nothing: byte code, and what can be made again.
_PASSED_OVER = frozenset({"__pycache__", "stages", "unchanged"})


class KeptAnswer:
    """One answer: known as long as nothing it depends on has changed.

    Parameters
    ----------
    what
        Names the question.
    directories
        Of the records that it is about.
    """

    def __init__(self, what: str, directories: Sequence[Path]) -> None:
        places = [str(directory.resolve()) for directory in directories]
        name = hashlib.sha256("\n".join([str(_ROOT), what, *places]).encode()).hexdigest()[:32]
        self._file = user_cache() / "unchanged" / name
        self._fingerprint = fingerprint(directories)

    def recall(self) -> Any:
        """Return the answer; None where it is not known."""
        content = read_checked(self._file)
        held = {} if content is None else json.loads(content)
        return held["answer"] if held.get("of") == self._fingerprint else None

    def keep(self, answer: Any) -> None:
        """Keep an answer, made since this object was; nothing where it cannot be written."""
        with suppress(OSError):
            held = {"of": self._fingerprint, "answer": answer}
            write_checked(self._file, json.dumps(held).encode())


def fingerprint(directories: Sequence[Path]) -> str:
    """Return a digest of the sources, of the files in directories, and of what is installed."""
    found = hashlib.sha256(" ".join([sys.version, *map(version, _INSTALLED)]).encode())
    places = [*(str(_ROOT / package) for package in _PACKAGES), *map(str, directories)]
    for place in places:
        for line in sorted(_stamps(place)):
            found.update(line.encode())
    return found.hexdigest()


def _stamps(directory: str) -> Iterator[str]:
    with suppress(OSError), os.scandir(directory) as entries:
        for entry in entries:
            if entry.is_dir():
                if entry.name not in _PASSED_OVER:
                    yield from _stamps(entry.path)
            elif "." in entry.name[1:] and not entry.name.endswith(".lock"):  # no other cache
                status = entry.stat()
                yield f"{entry.path} {status.st_size} {status.st_mtime_ns}\n"
