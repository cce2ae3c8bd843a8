"""Checking a directory of tables: form, types, keys, and what the survey's data must keep.

Three passes, each over what the pass before found sound: the form of every file
(`csv_reading`), types, enumerations, primary and foreign keys (frictionless against
``datapackage.json``), and the rules a descriptor cannot say (`rules`).
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import frictionless

from files.reading import FileRefusedError, read_json
from survey_data.descriptor import (
    DATA_DIRECTORY,
    DESCRIPTOR_FILE,
    column_types,
    descriptor,
    file_name,
    primary_key,
    table_names,
)
from survey_data.nearest import one_of
from survey_data.problems import Problem
from survey_data.table_records import Records, read_table_records
from survey_data.tables import MAY_BE_EMPTY, typed_frame
from survey_data.validation.rules import check_rules

_FORMS = {
    "key": "letters, four digits of the year and at most one small letter",
    "doi": "a DOI such as 10.3390/s21010001",
    "url": "an address that starts with https:// or http://",
}


def validate(directory: str | Path | None = None) -> list[Problem]:
    """Return every problem of the tables in a directory; an empty list means they are valid.

    They are in the order of file, row and column. A table whose form is broken is left out of the
    checks of content, so that one broken cell is not reported a hundred times.

    Raises
    ------
    NotADirectoryError
        There is no such directory. Nothing in the files themselves raises.
    """
    folder = DATA_DIRECTORY if directory is None else Path(directory)
    if not folder.is_dir():
        raise NotADirectoryError(f"expected a directory of survey tables, got {folder}")
    problems = _check_descriptor(folder)
    sound: dict[str, Records] = {}
    for table in table_names():
        records = read_table_records(folder, table)
        problems += records.problems
        if not (records.problems or records.rows or table in MAY_BE_EMPTY):
            problems.append(
                Problem(file_name(table), 1, None, "the table has a header and no rows")
            )
        if not records.problems:
            sound[table] = records
    problems += check_records(sound, sound)
    return sorted(set(problems), key=lambda p: (p.file, p.row or 0, p.column or "", p.message))


def check_records(sound: Mapping[str, Records], named: Collection[str]) -> list[Problem]:
    """Return the problems of the content of tables whose form is sound.

    Rules run where all that they need are there; types, enumerations and keys are checked of those
    `named`.
    """
    problems = _check_schema({name: sound[name] for name in named})
    frames = {}
    for table, records in sound.items():
        frame, flaws = typed_frame(table, records)
        if not flaws:  # frictionless has named them
            frames[table] = frame
    return problems + check_rules(frames)


def _check_descriptor(folder: Path) -> list[Problem]:
    path = folder / DESCRIPTOR_FILE
    try:
        found = read_json(path)
    except FileNotFoundError:
        return [Problem(DESCRIPTOR_FILE, None, None, "the file is missing")]
    except FileRefusedError as error:
        return [Problem(DESCRIPTOR_FILE, error.line, None, error.reason)]
    ours, theirs = (json.dumps(each, sort_keys=True) for each in (descriptor(), found))
    if ours == theirs:
        return []
    return [Problem(DESCRIPTOR_FILE, None, None, "differs from the descriptor in use")]


def _check_schema(sound: dict[str, Records]) -> list[Problem]:
    """Types, enumerations, patterns, primary and foreign keys, by frictionless.

    The rows are handed over as they were read, so that the row numbers are those of the file;
    foreign keys into a table that could not be read are left out.
    """
    package = descriptor()
    resources = []
    for resource in package["resources"]:
        table = resource["name"]
        if table not in sound:
            continue
        schema = resource["schema"]
        schema["foreignKeys"] = [
            key for key in schema.get("foreignKeys", []) if key["reference"]["resource"] in sound
        ]
        for entry in ("path", "format", "mediatype", "encoding"):
            resource.pop(entry)
        resource["data"] = [sound[table].header, *(cells for _, cells in sound[table].rows)]
        resources.append(resource)
    if not resources:
        return []
    package["resources"] = resources
    report = frictionless.Package.from_descriptor(package).validate()
    problems = [Problem(DESCRIPTOR_FILE, None, None, str(error.note)) for error in report.errors]
    for task in report.tasks:
        rows = sound[task.name].rows
        problems += [_as_problem(task.name, error, rows) for error in task.errors]
    return problems


def _as_problem(table: str, error: Any, rows: list[tuple[int, list[str]]]) -> Problem:
    counted = getattr(error, "row_number", None)
    row = rows[counted - 2][0] if isinstance(counted, int) and counted >= 2 else 1
    column = getattr(error, "field_name", None)
    if column is None:
        names = getattr(error, "field_names", None)
        column = names[-1] if error.type == "foreign-key" and names else primary_key(table)[0]
    note = error.note or error.message
    if error.type == "constraint-error":
        return Problem(file_name(table), row, str(column), _broken_constraint(table, error))
    if error.type == "type-error":
        kind = column_types(table)[str(column)]
        return Problem(file_name(table), row, str(column), f"expected a {kind}, got {error.cell!r}")
    if error.type == "primary-key":
        note = f"duplicate row: the key ({', '.join(primary_key(table))}) stands already: {note}"
    return Problem(file_name(table), row, str(column), f"{error.title}: {note}")


def _broken_constraint(table: str, error: Any) -> str:
    """Say in words what a cell should have been by its column's constraints."""
    fields = next(r for r in descriptor()["resources"] if r["name"] == table)["schema"]["fields"]
    constraints = next(f for f in fields if f["name"] == error.field_name)["constraints"]
    broken = str(error.note).split('"')[1]
    if broken == "required":
        return "expected a value, got none"
    if broken == "enum":
        return f"{error.cell!r}: {one_of(error.cell, constraints['enum'])}"
    if broken == "pattern":
        form = _FORMS.get(error.field_name, constraints["pattern"])
        return f"expected {form}, got {error.cell!r}"
    limits = " to ".join(
        str(constraints[name]) for name in ("minimum", "maximum") if name in constraints
    )
    return f"expected {limits}, got {error.cell!r}" if limits else str(error.note)
