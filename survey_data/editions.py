"""The editions of the facts: the survey's studies, frozen, and those that came after it.

The survey's tables are what its counts and findings are checked on, and stay as they are. Later
studies stand in tables of the same columns in `extension/`; the edition ``all`` is both together.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from files.json_data import JsonData
from survey_data.descriptor import (
    DATA_DIRECTORY,
    descriptor,
    file_name,
    table_names,
)

Choice = Literal["survey", "all"]
CHOICES: tuple[Choice, ...] = ("survey", "all")
"""What can be asked for; `survey` is the default everywhere."""

SURVEY, EXTENSION = "survey", "extension"
"""Edition of a single study."""

FOLDER = "extension"
"""Folder of the tables of later studies."""

BY_STUDY = ("studies", "attributes", "roles", "architectures")
"""Tables of studies, which the extension has of its own."""

EXTENSION_TABLES = tuple(name for name in table_names() if file_name(name).startswith(FOLDER))


@dataclass(frozen=True)
class Edition(JsonData):
    """An edition as it is cited.

    ``version`` is that of the data package, then the number of studies and the first digits of the
    SHA-256 of the edition's tables: it changes with every cell and with nothing else.
    """

    name: str
    title: str
    studies: int
    version: str


def editions(directory: Path = DATA_DIRECTORY) -> tuple[Edition, Edition]:
    """Return the survey's edition and its extension, as they are in a folder of tables.

    Raises
    ------
    OSError
        A table cannot be read.
    """
    survey = [name for name in table_names() if name not in EXTENSION_TABLES]
    return (
        _edition(SURVEY, "Studies of the survey", "studies", survey, directory),
        _edition(
            EXTENSION, "Studies after the survey", "extension_studies", EXTENSION_TABLES, directory
        ),
    )


def _edition(
    name: str, title: str, table: str, tables: list[str] | tuple[str, ...], folder: Path
) -> Edition:
    found = hashlib.sha256()
    for file in map(file_name, tables):
        data = (folder / file).read_bytes()
        found.update(f"{file} {len(data)}\n".encode() + data)
    rows = (folder / file_name(table)).read_bytes().count(b"\n") - 1  # one record a line
    version = f"{descriptor()['version']}+{rows}.{found.hexdigest()[:8]}"
    return Edition(name, title, rows, version)
