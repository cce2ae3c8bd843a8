"""What another table says of our studies, cell by cell, before anything is written."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import pandas as pd

from files.json_data import JsonData
from files.problems import Problem
from survey_data.importing.columns import ColumnMapping
from survey_data.importing.studies import StudyFinder, StudyNotFoundError, cell_text
from survey_data.importing.values import (
    UnreadableValueError,
    ValueMatch,
    ValueReader,
    column_unit,
)
from survey_data.problems import SurveyImportError
from survey_data.reported import KIND_OF, UNSPECIFIED
from survey_data.tables import RESTING, SurveyTables

AUTHORS_BASIS = "authors-table"
_SAME_NUMBER = 5e-3  # tables round their angles to two or three digits

Kind = Literal["new", "changed", "confirmed", "conflict"]


@dataclass(frozen=True)
class Difference(JsonData):
    """A cell (study, attribute) that another table states otherwise, or on better evidence.

    `basis` is ours, the strongest of the cell. `kind`: ``new`` (ours is unknown), ``changed``,
    ``confirmed`` (the same values; only the basis rises), ``conflict`` (ours is printed in the
    survey's own tables, outranks theirs and stays). `row` and `column` are theirs.
    """

    study: str
    attribute: str
    ours: tuple[str, ...]
    theirs: tuple[str, ...]
    basis: str
    kind: Kind
    row: int
    column: str


@dataclass(frozen=True)
class UnmatchedRow:
    """A row of another table that is about none of our studies, and why."""

    row: int
    reason: str


@dataclass(frozen=True)
class Withdrawn:
    """A row of ours that rests on a value which another table replaces, and so goes with it."""

    table: str
    study: str
    value: str
    note: str


@dataclass(frozen=True)
class ImportPlan(JsonData):
    """What an import would do.

    `differences` holds new, changed and conflicting cells, `confirmed` the cells whose basis
    alone rises; `guesses` the values read by similarity (score below 1); `errors` the cells that
    could not be read, which forbid applying; `withdrawn` the rows of our other tables that rest on
    a replaced value; `written` the number of cells that have been written.
    """

    source: str
    mapping: ColumnMapping
    matched: tuple[tuple[int, str], ...]
    unmatched: tuple[UnmatchedRow, ...]
    differences: tuple[Difference, ...]
    confirmed: tuple[Difference, ...]
    guesses: tuple[ValueMatch, ...]
    errors: tuple[Problem, ...]
    withdrawn: tuple[Withdrawn, ...] = ()
    written: int = 0

    @property
    def edits(self) -> tuple[Difference, ...]:
        """Return the cells that applying writes: in a conflict the survey's printed cells stay."""
        taken = tuple(entry for entry in self.differences if entry.kind != "conflict")
        return taken + self.confirmed

    def after_writing(self) -> ImportPlan:
        """Return the plan with its edits counted as written."""
        return replace(self, written=len(self.edits))

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON data."""
        matched = [{"row": row, "study": study} for row, study in self.matched]
        return {**super().to_dict(), "matched": matched}


@dataclass(frozen=True)
class _Cell:
    """Ours: the values of a (study, attribute) and their strongest basis."""

    values: tuple[str, ...]
    basis: str


def plan_import(
    tables: SurveyTables, frame: pd.DataFrame, mapping: ColumnMapping, source: str = "table"
) -> ImportPlan:
    """Compare another table with ours, cell by cell.

    Several rows on one study (same key or title) are united. A cell that states nothing leaves
    ours as it is.

    Parameters
    ----------
    tables : SurveyTables
        Ours.
    frame : pandas.DataFrame
        Theirs, as `read_table` returns it.
    mapping : ColumnMapping
        As `match_columns` returns it.
    source : str
        Name of the table, for messages.

    Returns
    -------
    ImportPlan
        Unreadable values are listed in its `errors`, rows on unknown studies in `unmatched`.

    Raises
    ------
    SurveyImportError
        Not one row is about a study of ours.
    """
    reader = ValueReader(tables)
    matched, unmatched, errors = _match_rows(tables, frame, mapping, source)
    if not matched:
        reason = f": row {unmatched[0].row}, {unmatched[0].reason}" if unmatched else ""
        raise SurveyImportError(f"no row of {source} is about one of our studies{reason}")
    single = {
        str(row["attribute"])
        for row in tables.attribute_definitions.to_dict("records")
        if not row["multiple"]
    }
    stated: dict[tuple[str, str], dict[str, ValueMatch]] = {}
    place: dict[tuple[str, str], tuple[int, str]] = {}
    for row, study in matched:
        for match in mapping.matches:
            if match.target not in mapping.attributes:
                continue
            text = cell_text(frame, row, match.column)
            try:
                values = reader.read(match.target, text, column_unit(match.column))
            except UnreadableValueError as error:
                errors.append(Problem(source, row, match.column, str(error)))
                continue
            cell = (study, match.target)
            for value in values:
                stated.setdefault(cell, {}).setdefault(value.value, value)
                place.setdefault(cell, (row, match.column))
            if match.target in single and len(stated.get(cell, ())) > 1:
                found = ", ".join(stated[cell])
                message = f"{study} takes one {match.target}, got {found}"
                errors.append(Problem(source, row, match.column, message))
    found_cells = _compare(tables, stated, place)
    guesses = {
        (value.attribute, value.text): value
        for values in stated.values()
        for value in values.values()
        if value.score < 1
    }
    return ImportPlan(
        source=source,
        mapping=mapping,
        matched=tuple(matched),
        unmatched=tuple(unmatched),
        differences=tuple(entry for entry in found_cells if entry.kind != "confirmed"),
        confirmed=tuple(entry for entry in found_cells if entry.kind == "confirmed"),
        guesses=tuple(guesses.values()),
        errors=tuple(errors),
        withdrawn=_withdrawn(tables, found_cells),
    )


def _withdrawn(tables: SurveyTables, cells: Iterable[Difference]) -> tuple[Withdrawn, ...]:
    """Return the rows of our other tables that rest on values that cells replace."""
    gone = {
        (cell.study, cell.attribute, value)
        for cell in cells
        if cell.kind == "changed"
        for value in set(cell.ours) - set(cell.theirs)
    }
    roles = (
        Withdrawn("roles", row["study"], row["value"], f"{row['role']}: {row['note']}")
        for row in tables.roles.fillna("").to_dict("records")
        if (row["study"], row["attribute"], row["value"]) in gone
    )
    pairs = (
        Withdrawn("architectures", row["study"], f"{row['detector']} + {row['mask']}", row["note"])
        for row in tables.architectures.fillna("").to_dict("records")
        if any((row["study"], part, row[part]) in gone for part in ("detector", "mask"))
    )
    models = (
        Withdrawn(
            table, row["study"], " + ".join(row[name] for name in RESTING[table]), row["note"]
        )
        for table in ("compensated_models", "method_variants")
        for row in getattr(tables, table).fillna("").to_dict("records")
        if any((row["study"], "model", row[name]) in gone for name in RESTING[table])
    )
    return (*roles, *pairs, *models)


def require_readable(plan: ImportPlan) -> None:
    """Raise SurveyImportError with the first unreadable cell of a plan, if there is one."""
    if plan.errors:
        first = plan.errors[0]
        more = f" (and {len(plan.errors) - 1} more)" if len(plan.errors) > 1 else ""
        raise SurveyImportError(
            first.message + more, row=first.row, column=first.column, problems=plan.errors
        )


def _match_rows(
    tables: SurveyTables, frame: pd.DataFrame, mapping: ColumnMapping, source: str
) -> tuple[list[tuple[int, str]], list[UnmatchedRow], list[Problem]]:
    finder = StudyFinder(tables)
    columns = {
        target: next(iter(mapping.columns(target)), None)
        for target in ("study", "title", "authors", "year")
    }
    matched: list[tuple[int, str]] = []
    unmatched: list[UnmatchedRow] = []
    errors: list[Problem] = []
    named: dict[str, tuple[int, tuple[str, ...]]] = {}
    for row in map(int, frame.index):
        said = {target: cell_text(frame, row, column) for target, column in columns.items()}
        try:
            study = finder.find(said["study"], said["title"], said["authors"], said["year"])
        except StudyNotFoundError as error:
            unmatched.append(UnmatchedRow(row, str(error)))
            continue
        identity = tuple(said.values())
        first_row, first = named.setdefault(study, (row, identity))
        if first != identity:
            column = next(column for column in columns.values() if column is not None)
            message = f"means {study}, as row {first_row} does, but names it otherwise"
            errors.append(Problem(source, row, column, message))
            continue
        matched.append((row, study))
    return matched, unmatched, errors


def _compare(
    tables: SurveyTables,
    stated: Mapping[tuple[str, str], Mapping[str, ValueMatch]],
    place: Mapping[tuple[str, str], tuple[int, str]],
) -> list[Difference]:
    rank = dict(zip(tables.bases["basis"], tables.bases["rank"].astype(int), strict=True))
    ours = current_cells(tables)
    printed = _print_text(tables)
    found = []
    for (study, attribute), values in stated.items():
        cell = ours.get((study, attribute), _Cell((), "unknown"))
        theirs = tuple(values)
        # The survey may print a parent whose kind rests on less: theirs has to be one of its kinds.
        against = any(
            not printed_values & set(theirs)
            for printed_values in printed.get((study, attribute), ())
        )
        outranked = against or rank[cell.basis] < rank[AUTHORS_BASIS]
        if _same_values(cell.values, theirs):
            if rank[cell.basis] <= rank[AUTHORS_BASIS]:
                continue
            kind: Kind = "confirmed"
            theirs = cell.values
        elif outranked:
            kind = "conflict"
        else:
            kind = "changed" if cell.values else "new"
        row, column = place[study, attribute]
        found.append(
            Difference(study, attribute, cell.values, theirs, cell.basis, kind, row, column)
        )
        if kind == "changed" and attribute in KIND_OF:
            found += _kind_of_another(ours, stated, found[-1])
    return found


def _kind_of_another(
    ours: Mapping[tuple[str, str], _Cell],
    stated: Mapping[tuple[str, str], Mapping[str, ValueMatch]],
    number: Difference,
) -> list[Difference]:
    """Return the kind of a replaced accuracy or precision as unspecified, unless theirs says it."""
    kind = KIND_OF[number.attribute]
    cell = ours.get((number.study, kind))
    if cell is None or cell.values == (UNSPECIFIED,) or (number.study, kind) in stated:
        return []
    return [replace(number, attribute=kind, ours=cell.values, theirs=(UNSPECIFIED,))]


def _print_text(tables: SurveyTables) -> dict[tuple[str, str], list[set[str]]]:
    """Return of each cell (study, attribute) what each of the survey's printed labels may mean."""
    meant: dict[tuple[str, str], set[str]] = {}
    for alias in tables.aliases.to_dict("records"):
        if alias["origin"] == "survey":
            at = (str(alias["attribute"]), str(alias["alias"]))
            meant.setdefault(at, set()).add(str(alias["value"]))
    found: dict[tuple[str, str], list[set[str]]] = {}
    for cell in tables.study_tables.to_dict("records"):
        study, attribute, label = str(cell["study"]), str(cell["attribute"]), str(cell["value"])
        values = {label} | meant.get((attribute, label), set())
        found.setdefault((study, attribute), []).append(values)
    return found


def current_cells(tables: SurveyTables) -> dict[tuple[str, str], _Cell]:
    """Return (study, attribute) -> our values, in file order, and their strongest basis."""
    rank = dict(zip(tables.bases["basis"], tables.bases["rank"].astype(int), strict=True))
    cells: dict[tuple[str, str], _Cell] = {}
    for record in tables.attributes.to_dict("records"):
        at = (str(record["study"]), str(record["attribute"]))
        value = () if pd.isna(record["value"]) else (str(record["value"]),)
        before = cells.get(at)
        basis = str(record["basis"])
        if before is not None and rank[before.basis] < rank[basis]:
            basis = before.basis
        cells[at] = _Cell((before.values if before else ()) + value, basis)
    return cells


def _same_values(ours: tuple[str, ...], theirs: tuple[str, ...]) -> bool:
    if set(ours) == set(theirs):
        return True
    if len(ours) != 1 or len(theirs) != 1:
        return False
    try:
        return math.isclose(float(ours[0]), float(theirs[0]), rel_tol=_SAME_NUMBER)
    except ValueError:
        return False
