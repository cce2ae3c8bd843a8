"""Records of the survey's own tables, each under its file's name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from files.strict_csv import Records
from files.whole_csv import read_whole_records
from survey_data.descriptor import column_types, file_name


def read_table_records(folder: Path, table: str) -> Records:
    """Read a table of a folder as `read_whole_records` does; problems name its file there."""
    name = file_name(table)
    records = read_whole_records(folder / name, list(column_types(table)))
    records.problems = [replace(each, file=name) for each in records.problems]
    return records
