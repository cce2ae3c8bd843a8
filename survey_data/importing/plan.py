"""What another table says of our studies, cell by cell, before anything is written."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import pandas as pd
from pydantic import BaseModel, ConfigDict

from survey_data.importing.columns import ColumnMapping
from survey_data.importing.studies import StudyFinder, StudyNotFoundError, cell_text
from survey_data.importing.values import (
    UnreadableValueError,
    ValueMatch,
    ValueReader,
    column_unit,
)
from survey_data.problems import Problem, SurveyImportError
from survey_data.reported import KIND_OF, UNSPECIFIED
from survey_data.tables import RESTING, SurveyTables

AUTHORS_BASIS = "authors-table"
_SAME_NUMBER = 5e-3  # tables round their angles to two or three digits

Kind = Literal["new", "changed", "confirmed", "conflict"]


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True)


class Difference(_Frozen):
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

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON data."""
        return self.model_dump(mode="json")


class UnmatchedRow(_Frozen):
    """A row of another table that is about none of our studies, and why."""

    row: int
    reason: str


class Withdrawn(_Frozen):
    """A row of ours that rests on a value which another table replaces, and so goes with it."""

    table: str
    study: str
    value: str
    note: str


class ImportPlan(_Frozen):
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

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON data."""
        matched = [{"row": row, "study": study} for row, study in self.matched]
        return {**self.model_dump(mode="json"), "matched": matched}


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
    definitions = tables.attribute_definitions
    single = set(definitions.loc[~definitions["multiple"], "attribute"])
    columns = [match for match in mapping.matches if match.target in mapping.attributes]
    stated: dict[tuple[str, str], dict[str, ValueMatch]] = {}
    place: dict[tuple[str, str], tuple[int, str]] = {}
    for (row, study), match in itertools.product(matched, columns):
        cell = (study, match.target)
        text = cell_text(frame, row, match.column)
        try:
            for value in reader.read(match.target, text, column_unit(match.column)):
                stated.setdefault(cell, {}).setdefault(value.value, value)
                place.setdefault(cell, (row, match.column))
        except UnreadableValueError as error:
            errors.append(Problem(source, row, match.column, str(error)))
            continue
        if match.target in single and len(stated.get(cell, ())) > 1:
            message = f"{study} takes one {match.target}, got {', '.join(stated[cell])}"
            errors.append(Problem(source, row, match.column, message))
    found = _compare(tables, stated, place)
    values = [value for cell in stated.values() for value in cell.values() if value.score < 1]
    return ImportPlan(
        source=source,
        mapping=mapping,
        matched=tuple(matched),
        unmatched=tuple(unmatched),
        differences=tuple(entry for entry in found if entry.kind != "confirmed"),
        confirmed=tuple(entry for entry in found if entry.kind == "confirmed"),
        guesses=tuple({(value.attribute, value.text): value for value in values}.values()),
        errors=tuple(errors),
        withdrawn=tuple(_withdrawn(tables, found)),
    )


def _withdrawn(tables: SurveyTables, cells: Iterable[Difference]) -> Iterator[Withdrawn]:
    """Give the rows of our other tables that rest on values that cells replace."""
    gone = {
        (cell.study, cell.attribute, value)
        for cell in cells
        if cell.kind == "changed"
        for value in set(cell.ours) - set(cell.theirs)
    }
    for table, names in RESTING.items():
        for row in getattr(tables, table).fillna("").to_dict("records"):
            if table == "roles":
                rests, note = [(row["attribute"], row["value"])], f"{row['role']}: {row['note']}"
            else:
                parts = names if table == "architectures" else ["model"] * len(names)
                rests, note = [*zip(parts, map(row.get, names), strict=True)], row["note"]
            if any((row["study"], *each) in gone for each in rests):
                value = " + ".join(row[name] for name in names)
                yield Withdrawn(table=table, study=row["study"], value=value, note=note)


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
            unmatched.append(UnmatchedRow(row=row, reason=str(error)))
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
        said = Difference(
            study=study,
            attribute=attribute,
            ours=cell.values,
            theirs=theirs,
            basis=cell.basis,
            kind=kind,
            row=place[study, attribute][0],
            column=place[study, attribute][1],
        )
        found.append(said)
        # The kind of a replaced accuracy or precision is unspecified, unless theirs says it.
        of_kind = KIND_OF.get(attribute, "")
        old = ours.get((study, of_kind))
        if kind == "changed" and old is not None and (study, of_kind) not in stated:
            changed = {"attribute": of_kind, "ours": old.values, "theirs": (UNSPECIFIED,)}
            found += [said.model_copy(update=changed)] if old.values != (UNSPECIFIED,) else []
    return found


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
