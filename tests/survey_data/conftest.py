"""The shipped tables, and copies of them to corrupt."""

from __future__ import annotations

import csv
import io
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

import survey_data
from files.manifest import FILE
from survey_data.descriptor import DATA_DIRECTORY, DESCRIPTOR_FILE, file_name, table_names


@dataclass(frozen=True)
class Copy:
    """A copy of the data directory whose tables can be edited as lists of cells."""

    directory: Path

    def path(self, table: str) -> Path:
        return self.directory / file_name(table)

    def rows(self, table: str) -> list[list[str]]:
        with self.path(table).open(encoding="utf-8", newline="") as stream:
            return list(csv.reader(stream))

    def write(self, table: str, rows: list[list[str]]) -> None:
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(rows)
        self.path(table).write_text(text.getvalue(), encoding="utf-8", newline="")

    def edit(self, table: str, change: Callable[[list[list[str]]], None]) -> None:
        rows = self.rows(table)
        change(rows)
        self.write(table, rows)

    def set(self, table: str, row: int, column: str, text: str) -> None:
        """Set a cell; `row` as in the file (header 1)."""
        rows = self.rows(table)
        rows[row - 1][rows[0].index(column)] = text
        self.write(table, rows)

    def found(self, file: str) -> list[survey_data.Problem]:
        """Problems of one file."""
        return [p for p in survey_data.validate(self.directory) if p.file == file]


def copy_data(directory: Path) -> Copy:
    for name in (DESCRIPTOR_FILE, *map(file_name, table_names())):
        (directory / name).parent.mkdir(exist_ok=True)
        shutil.copyfile(DATA_DIRECTORY / name, directory / name)
    return Copy(directory)


@pytest.fixture(scope="session")
def tables() -> survey_data.SurveyTables:
    return survey_data.load()


@pytest.fixture
def copy(tmp_path: Path) -> Copy:
    return copy_data(tmp_path)


@pytest.fixture
def recorded(copy: Copy) -> Path:
    """A copy of the tables with their manifest."""
    (copy.directory / FILE).write_bytes((DATA_DIRECTORY / FILE).read_bytes())
    return copy.directory
