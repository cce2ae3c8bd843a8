"""The survey's tables as text, for who wants their words and not frames of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace

from survey_data.descriptor import DATA_DIRECTORY, column_types
from survey_data.problems import Problem, SurveyDataError
from survey_data.table_records import read_table_records

Rows = Sequence[Mapping[str, str]]


def load_texts(tables: Sequence[str], directory: Path = DATA_DIRECTORY) -> SimpleNamespace:
    """Read tables by name as `survey_data.load` does, but every cell as text; an empty one is "".

    That takes no pandas, which takes longer to import than all the tables to read. Gives a sequence
    of rows a table, each a mapping of its columns. SurveyDataError names file, row and column where
    a file is missing or broken.
    """
    found: dict[str, Rows] = {}
    problems: list[Problem] = []
    for table in tables:
        columns = list(column_types(table))
        records = read_table_records(directory, table)
        problems += records.problems
        found[table] = [dict(zip(columns, cells, strict=True)) for _, cells in records.rows]
    if problems:
        raise SurveyDataError(tuple(problems))
    return SimpleNamespace(**found)
