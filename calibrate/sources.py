"""Files of a calibration: tables, or pictures with one, and their digests."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from calibrate.frames import of_spots, table_in, with_spots
from calibrate.roles import understood
from calibrate.settings import Settings
from calibrate.table import Table, read_table
from files.reading import read_bytes

_LARGEST = 512 * 1024 * 1024


@dataclass(frozen=True)
class Sources:
    """What files of one sensor hold.

    Attributes
    ----------
    tables : tuple of Table
        One a file; pictures are spots already.
    settings : Settings
        Of the tables.
    notes : tuple of str
        On how the files and pictures were read.
    digest : str
        SHA-256 of all files, 32 digits.
    digests : tuple of str
        SHA-256 of each file.
    """

    tables: tuple[Table, ...]
    settings: Settings
    notes: tuple[str, ...]
    digest: str
    digests: tuple[str, ...]


def read_sources(
    paths: Sequence[Path],
    settings: Settings | None = None,
    progress: Callable[[str, int, int], None] = lambda *_: None,
) -> Sources:
    """Read files, or directories of pictures with one table each; settings are guessed if none.

    Raises
    ------
    TableError
        If a file is none, or lacks a column.
    """
    paths = [table_in(path) if path.is_dir() else path for path in paths]
    tables = [read_table(path, settings.file if settings else None) for path in paths]
    stated, notes = _stated(tables, settings)
    if stated.readings.kind == "frames":
        for at, path in enumerate(paths):
            tables[at], said = with_spots(
                tables[at], path.parent, stated, lambda done, all_: progress("frames", done, all_)
            )
            notes += said
        stated = of_spots(stated)
    whole = hashlib.sha256()
    digests = []
    for path in paths:
        data = read_bytes(path, _LARGEST)
        whole.update(data)
        digests.append(hashlib.sha256(data).hexdigest())
    return Sources(tuple(tables), stated, tuple(notes), whole.hexdigest()[:32], tuple(digests))


def _stated(tables: Sequence[Table], settings: Settings | None) -> tuple[Settings, list[str]]:
    """Return settings, guessed where none are stated, and how files and columns were read."""
    notes = list(dict.fromkeys(note for table in tables for note in table.notes))
    if settings is not None:
        return settings, notes
    guessed = understood(tables[0])
    return guessed.settings, [*notes, *guessed.notes]
