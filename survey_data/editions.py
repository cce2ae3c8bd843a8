"""The editions of the facts: the survey's studies, frozen, and studies that it does not map.

The survey's tables are what its counts and findings are checked on, and stay as they are. Studies
that it does not map stand in tables of the same columns in `extension/`, some of its own years and
some later; the edition ``all`` is both together.
"""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from survey_data.descriptor import DATA_DIRECTORY, descriptor, file_name, table_names
from survey_data.json_data import JsonData

Choice = Literal["survey", "all"]
CHOICES: tuple[Choice, ...] = ("survey", "all")
"""What can be asked for; `survey` is the default everywhere."""

SURVEY, EXTENSION = "survey", "extension"
"""Edition of a single study."""

FOLDER = "extension"
"""Folder of the tables of studies that the survey does not map."""

BY_STUDY = ("studies", "attributes", "roles", "architectures")
"""Tables of studies, which the extension has of its own."""

EXTENSION_TABLES = tuple(name for name in table_names() if file_name(name).startswith(FOLDER))


@dataclass(frozen=True)
class Edition(JsonData):
    """An edition as it is cited.

    ``version`` is that of the data package, then the number of studies and the first digits of the
    SHA-256 of the edition's tables: it changes with every cell and with nothing else. `last_year`
    is that of its latest study, and `later` counts those after the survey's latest.
    """

    name: str
    title: str
    studies: int
    last_year: int
    later: int
    version: str


def editions(directory: Path = DATA_DIRECTORY) -> tuple[Edition, Edition]:
    """Return the survey's edition and its extension, as they are in a folder of tables.

    Raises
    ------
    OSError
        A table cannot be read.
    """
    mapped, others = _years("studies", directory), _years("extension_studies", directory)
    last = max(mapped)
    tables = [name for name in table_names() if name not in EXTENSION_TABLES]
    title = "Studies the survey does not map"
    return (
        Edition(SURVEY, "Studies of the survey", *_counts(mapped, last, tables, directory)),
        Edition(EXTENSION, title, *_counts(others, last, EXTENSION_TABLES, directory)),
    )


def _years(table: str, folder: Path) -> list[int]:
    """Return the year of each study of a table, 0 where it is unknown."""
    with (folder / file_name(table)).open(encoding="utf-8", newline="") as file:
        return [int(row["year"] or 0) for row in csv.DictReader(file)]


def _counts(
    years: list[int], last: int, tables: Iterable[str], folder: Path
) -> tuple[int, int, int, str]:
    """Return what an edition says of its studies, of these years, and of its tables."""
    found = hashlib.sha256()
    for file in map(file_name, tables):
        data = (folder / file).read_bytes()
        found.update(f"{file} {len(data)}\n".encode() + data)
    version = f"{descriptor()['version']}+{len(years)}.{found.hexdigest()[:8]}"
    return len(years), max(years, default=0), sum(year > last for year in years), version
