"""What was found in source files, kept by path, size and time of the last change."""

from __future__ import annotations

import json
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from benchmark.results.definitions import VERSION, Definitions, analyse, from_json
from files.checked import read_checked, write_checked
from files.user_cache import user_cache

_Stamp = tuple[int, int]


class Analyses:
    """Analyses of this process, and those that another one left in a file.

    The file is one that can be lost: damaged, it is read as empty; of two processes that write it,
    the last one's is kept.

    Parameters
    ----------
    file
        Where they are kept; nowhere for None.
    """

    def __init__(self, file: Path | None = None) -> None:
        self._file = file
        self._known: dict[str, tuple[_Stamp, Definitions]] = {}
        self._held: dict[str, Any] | None = None
        self._new = False

    @staticmethod
    @cache
    def of_user() -> Analyses:
        """Return those of the user's cache directory."""
        return Analyses(user_cache() / "definitions")

    def of(self, path: Path) -> Definitions:
        """Return what a file defines, analysed again where size or time are others.

        Raises
        ------
        ClosureError
            When it cannot be parsed.
        """
        name, status = str(path), path.stat()
        stamp = (status.st_size, status.st_mtime_ns)
        known = self._known.get(name)
        if known is None or known[0] != stamp:
            found = self._restored(name, stamp)
            if found is None:
                found, self._new = analyse(path.read_bytes(), name), True
            known = self._known[name] = (stamp, found)
        return known[1]

    def keep(self) -> None:
        """Write what was found beside what the file holds; nothing where it cannot be written."""
        if self._file is None or not self._new:
            return
        found = {name: [*stamp, *known] for name, (stamp, known) in self._known.items()}
        held = {**(self._held or {}), **found}
        there = {name: one for name, one in held.items() if Path(name).is_file()}
        with suppress(OSError):
            write_checked(self._file, json.dumps({"version": VERSION, "files": there}).encode())
            self._new = False

    def _restored(self, name: str, stamp: _Stamp) -> Definitions | None:
        if self._held is None:
            self._held = _read(self._file)
        size, time, *known = self._held.get(name, (None, None))
        return from_json(known) if (size, time) == stamp else None


def _read(file: Path | None) -> dict[str, Any]:
    content = None if file is None else read_checked(file)
    held: dict[str, Any] = {} if content is None else json.loads(content)
    return held["files"] if held.get("version") == VERSION else {}
