"""The survey's tables as tidy pandas frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import pandas as pd

from files.reading import parse_decimal, parse_integer
from survey_data.descriptor import DATA_DIRECTORY, column_types, file_name, primary_key, table_names
from survey_data.editions import BY_STUDY, EXTENSION, EXTENSION_TABLES, SURVEY, Choice
from survey_data.problems import Problem, SurveyDataError
from survey_data.table_records import Records, read_table_records

FIRST_ROW = 2  # the header is row 1, and the tables keep one record a line


@dataclass(frozen=True)
class SurveyTables:
    """Every table as a frame with a default index: row i stands in the file's row i + 2.

    Strings are str, whole numbers Int64, numbers float64, truth values bool; an empty cell is
    missing (NaN/NA). ``attributes.value`` is text for every attribute, numeric ones included.
    Columns and their meaning: ``datapackage.json``.
    """

    studies: pd.DataFrame
    attributes: pd.DataFrame
    taxonomy: pd.DataFrame
    attribute_definitions: pd.DataFrame
    bases: pd.DataFrame
    aliases: pd.DataFrame
    study_tables: pd.DataFrame
    feature_assessment: pd.DataFrame
    approaches: pd.DataFrame
    findings: pd.DataFrame
    finding_clauses: pd.DataFrame
    claims: pd.DataFrame
    references: pd.DataFrame
    counts: pd.DataFrame
    hardware: pd.DataFrame
    defaults: pd.DataFrame
    purposes: pd.DataFrame
    compensated_models: pd.DataFrame
    method_variants: pd.DataFrame
    run_facts: pd.DataFrame
    architectures: pd.DataFrame
    roles: pd.DataFrame
    advice: pd.DataFrame
    protocol: pd.DataFrame
    model_families: pd.DataFrame
    venues: pd.DataFrame
    statistics: pd.DataFrame
    sources: pd.DataFrame
    labels: pd.DataFrame
    processors: pd.DataFrame
    extension_studies: pd.DataFrame
    extension_attributes: pd.DataFrame
    extension_roles: pd.DataFrame
    extension_architectures: pd.DataFrame
    extension_names: pd.DataFrame
    verifications: pd.DataFrame

    def edition(self, name: Choice) -> SurveyTables:
        """Return the tables of an edition, with a column `edition` in the table of studies.

        Parameters
        ----------
        name : {"survey", "all"}
            ``all`` has the rows of studies that the survey does not map below its own, in
            `studies`, `attributes`, `roles` and `architectures`.
        """
        frames = {"studies": self.studies.assign(edition=SURVEY)}
        if name == "all":
            for table in BY_STUDY:
                later = getattr(self, f"extension_{table}")
                if table == "studies":
                    later = later.assign(edition=EXTENSION)
                ours = frames.get(table, getattr(self, table))
                frames[table] = pd.concat([ours, later], ignore_index=True)
        return replace(self, **frames)


def load(directory: str | Path | None = None) -> SurveyTables:
    """Read the tables of a directory, by default the package's own data.

    Form, types and keys are checked here, meaning by `validate`.

    Raises
    ------
    SurveyDataError
        A file is missing or broken, a table has no rows or a key twice, or a cell is not of its
        column's type; names file, row and column.
    """
    folder = DATA_DIRECTORY if directory is None else Path(directory)
    frames: dict[str, pd.DataFrame] = {}
    problems: list[Problem] = []
    for table in table_names():
        records = read_table_records(folder, table)
        problems += records.problems
        if not records.problems:
            frame, flaws = typed_frame(table, records)
            frames[table] = frame
            problems += flaws or _without_use(table, records)
    if problems:
        raise SurveyDataError(tuple(problems))
    return SurveyTables(**frames)


#: Tables that rest on values an import may replace, with the columns that name these values.
RESTING = {
    "roles": ("value",),
    "architectures": ("detector", "mask"),
    "compensated_models": ("compensation", "model"),
    "method_variants": ("model",),
}
#: Tables that an import may so empty, and those of what the survey does not map.
MAY_BE_EMPTY = frozenset({*RESTING, *EXTENSION_TABLES})


def _without_use(table: str, records: Records) -> list[Problem]:
    """Name a table without rows, and rows with the same key."""
    if not records.rows and table not in MAY_BE_EMPTY:
        return [Problem(file_name(table), 1, None, "the table has a header and no rows")]
    names = primary_key(table)
    at = [records.header.index(name) for name in names]
    seen: dict[tuple[str, ...], int] = {}
    problems = []
    for row, cells in records.rows:
        key = tuple(cells[k] for k in at)
        first = seen.setdefault(key, row)
        if first != row:
            said = f"{' '.join(key)!r} stands in row {first} already"
            problems.append(Problem(file_name(table), row, names[0], said))
    return problems


def typed_frame(table: str, records: Records) -> tuple[pd.DataFrame, list[Problem]]:
    """Return a table's records as a typed frame, and the cells that are not of their type."""
    problems: list[Problem] = []
    columns: dict[str, pd.Series] = {}
    for index, (name, kind) in enumerate(column_types(table).items()):
        convert, dtype = _CONVERSIONS[kind]
        values: list[object] = []
        for row, cells in records.rows:
            text = cells[index]
            try:
                values.append(convert(text) if text else None)
            except ValueError:
                values.append(None)
                problems.append(
                    Problem(file_name(table), row, name, f"expected {kind}, got {text!r}")
                )
        columns[name] = pd.Series(values, dtype=dtype)
    return pd.DataFrame(columns), problems


def _truth(text: str) -> bool:
    if text not in {"true", "false"}:
        raise ValueError(text)
    return text == "true"


_CONVERSIONS: dict[str, tuple[Callable[[str], object], str]] = {
    "string": (str, "str"),
    "integer": (parse_integer, "Int64"),
    "year": (parse_integer, "Int64"),
    "number": (parse_decimal, "float64"),
    "boolean": (_truth, "boolean"),
}
