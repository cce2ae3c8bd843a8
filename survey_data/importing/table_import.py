"""Another table of studies: compared with ours cell by cell, and taken over when asked."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Literal, NamedTuple

import pandas as pd
from pydantic import BaseModel

from survey_data.descriptor import DATA_DIRECTORY
from survey_data.importing.columns import ColumnMapping, match_columns
from survey_data.importing.studies import StudyFinder, StudyNotFoundError
from survey_data.importing.table_reader import read_table
from survey_data.importing.values import UnreadableValueError, ValueReader, column_unit
from survey_data.importing.writing import locked_tables, write_valid
from survey_data.problems import Problem, SurveyImportError
from survey_data.reported import KIND_OF, UNSPECIFIED
from survey_data.tables import RESTING, SurveyTables, load
from survey_data.texts import Rows, load_texts

_TABLE = "attributes"
AUTHORS_BASIS = "authors-table"
_SAME_NUMBER = 5e-3  # tables round their angles to two or three digits

Kind = Literal["new", "changed", "confirmed", "conflict"]


class Difference(BaseModel, frozen=True):
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


class MatchedRow(BaseModel, frozen=True):
    """A row of another table, and the study of ours that it is about."""

    row: int
    study: str


class UnmatchedRow(BaseModel, frozen=True):
    """A row of another table that is about none of our studies, and why."""

    row: int
    reason: str


class Withdrawn(BaseModel, frozen=True):
    """A row of ours that rests on a value which another table replaces, and so goes with it."""

    table: str
    study: str
    value: str
    note: str


class ImportPlan(BaseModel, frozen=True):
    """What an import would do.

    `differences` holds new, changed and conflicting cells, `confirmed` the cells whose basis
    alone rises; `errors` the cells that could not be read, which forbid applying; `withdrawn` the
    rows of our other tables that rest on a replaced value; `written` the number of cells that have
    been written.
    """

    source: str
    mapping: ColumnMapping
    matched: tuple[MatchedRow, ...]
    unmatched: tuple[UnmatchedRow, ...]
    differences: tuple[Difference, ...]
    confirmed: tuple[Difference, ...]
    errors: tuple[Problem, ...]
    withdrawn: tuple[Withdrawn, ...] = ()
    written: int = 0

    @property
    def edits(self) -> tuple[Difference, ...]:
        """The cells that applying writes: in a conflict the survey's printed cells stay."""
        taken = tuple(entry for entry in self.differences if entry.kind != "conflict")
        return taken + self.confirmed


class _Cell(NamedTuple):
    """Ours: the values of a (study, attribute) and their strongest basis."""

    values: tuple[str, ...] = ()
    basis: str = "unknown"


def import_table(
    path: str | Path,
    directory: str | Path | None = None,
    *,
    overrides: Mapping[str, str] | None = None,
    sheet: str | None = None,
    apply: bool = False,
) -> ImportPlan:
    """Compare a table with ours and, when asked, take over what it says.

    Parameters
    ----------
    path : str or Path
        CSV or XLSX file, see `read_table`.
    directory : str or Path, optional
        Our tables; by default the package's own data.
    overrides : mapping of str to str, optional
        Column -> target, see `match_columns`.
    sheet : str, optional
        Sheet of a workbook.
    apply : bool
        Write. Without it unreadable cells are listed in the plan's `errors` instead of raised.
        Applying the same table twice changes nothing the second time.

    Raises
    ------
    SurveyImportError
        The file is no table, its columns cannot be matched, or (with `apply`) a value cannot be
        read, the tables would be invalid or cannot be written; nothing has been written.
    SurveyDataError
        Our own tables cannot be read.
    """
    frame = read_table(path, sheet)
    folder = DATA_DIRECTORY if directory is None else Path(directory)
    with locked_tables(folder) if apply else nullcontext():
        tables = load(folder)
        mapping = match_columns(tables, frame, overrides)
        plan = plan_import(tables, frame, mapping, source=Path(path).name)
        return _write(folder, tables, plan) if apply else plan


def plan_import(
    tables: SurveyTables, frame: pd.DataFrame, mapping: ColumnMapping, source: str = "table"
) -> ImportPlan:
    """Compare another table, as `read_table` gives it, with ours; `source` is its name in messages.

    Several rows on one study (same key or title) are united. A cell that states nothing leaves
    ours as it is; one that cannot be read is among the plan's `errors`.

    Raises
    ------
    SurveyImportError
        Not one row is about a study of ours.
    """
    reader = ValueReader(tables)
    frame = frame.fillna("")
    matched, unmatched, errors = _match_rows(tables, frame, mapping, source)
    if not matched:
        reason = f": row {unmatched[0].row}, {unmatched[0].reason}" if unmatched else ""
        raise SurveyImportError(f"no row of {source} is about one of our studies{reason}")
    definitions = tables.attribute_definitions
    single = set(definitions.loc[~definitions["multiple"], "attribute"])
    columns = [match for match in mapping.matches if match.target in mapping.attributes]
    stated: dict[tuple[str, str], list[str]] = {}
    place: dict[tuple[str, str], tuple[int, str]] = {}
    for about, match in itertools.product(matched, columns):
        row, cell = about.row, (about.study, match.target)
        text = str(frame.at[row, match.column])
        try:
            values = reader.read(match.target, text, column_unit(match.column))
        except UnreadableValueError as error:
            errors.append(Problem(source, row, match.column, str(error)))
            continue
        if values:
            stated[cell] = list(dict.fromkeys([*stated.get(cell, ()), *values]))
            place.setdefault(cell, (row, match.column))
        if match.target in single and len(stated.get(cell, ())) > 1:
            message = f"{about.study} takes one {match.target}, got {', '.join(stated[cell])}"
            errors.append(Problem(source, row, match.column, message))
    found = _compare(tables, stated, place)
    return ImportPlan(
        source=source,
        mapping=mapping,
        matched=tuple(matched),
        unmatched=tuple(unmatched),
        differences=tuple(entry for entry in found if entry.kind != "confirmed"),
        confirmed=tuple(entry for entry in found if entry.kind == "confirmed"),
        errors=tuple(errors),
        withdrawn=tuple(_withdrawn(tables, found)),
    )


def _match_rows(
    tables: SurveyTables, frame: pd.DataFrame, mapping: ColumnMapping, source: str
) -> tuple[list[MatchedRow], list[UnmatchedRow], list[Problem]]:
    finder = StudyFinder(tables)
    columns = {
        target: mapping.columns(target)[0]
        for target in ("study", "title", "authors", "year")
        if mapping.columns(target)
    }
    matched: list[MatchedRow] = []
    unmatched: list[UnmatchedRow] = []
    errors: list[Problem] = []
    named: dict[str, tuple[int, tuple[str, ...]]] = {}
    for row in map(int, frame.index):
        said = {target: str(frame.at[row, column]) for target, column in columns.items()}
        try:
            study = finder.find(**said)
        except StudyNotFoundError as error:
            unmatched.append(UnmatchedRow(row=row, reason=str(error)))
            continue
        identity = tuple(said.values())
        first_row, first = named.setdefault(study, (row, identity))
        if first != identity:
            column = next(iter(columns.values()))
            message = f"means {study}, as row {first_row} does, but names it otherwise"
            errors.append(Problem(source, row, column, message))
            continue
        matched.append(MatchedRow(row=row, study=study))
    return matched, unmatched, errors


def _compare(
    tables: SurveyTables,
    stated: Mapping[tuple[str, str], Sequence[str]],
    place: Mapping[tuple[str, str], tuple[int, str]],
) -> list[Difference]:
    rank = dict(zip(tables.bases["basis"], tables.bases["rank"].astype(int), strict=True))
    ours = _current_cells(tables)
    printed = _print_text(tables)
    found = []
    for (study, attribute), values in stated.items():
        cell = ours.get((study, attribute), _Cell())
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


def _current_cells(tables: SurveyTables) -> dict[tuple[str, str], _Cell]:
    """Return (study, attribute) -> our values, in file order, and their strongest basis."""
    rank = dict(zip(tables.bases["basis"], tables.bases["rank"].astype(int), strict=True))
    cells: dict[tuple[str, str], _Cell] = {}
    for record in tables.attributes.to_dict("records"):
        at = (str(record["study"]), str(record["attribute"]))
        value = () if pd.isna(record["value"]) else (str(record["value"]),)
        before = cells.get(at, _Cell())
        basis = min(before.basis, str(record["basis"]), key=rank.__getitem__)
        cells[at] = _Cell(before.values + value, basis)
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


def _require_readable(plan: ImportPlan) -> None:
    """Raise SurveyImportError with the first unreadable cell of a plan, if there is one."""
    if plan.errors:
        first = plan.errors[0]
        more = f" (and {len(plan.errors) - 1} more)" if len(plan.errors) > 1 else ""
        raise SurveyImportError(
            first.message + more, row=first.row, column=first.column, problems=plan.errors
        )


def _write(folder: Path, tables: SurveyTables, plan: ImportPlan) -> ImportPlan:
    """Write a plan's edits into tables that this process holds, all or nothing.

    A cell taken over gets the basis ``authors-table``; what it said before, and on what basis,
    stays in its note. Rows of other tables that rest on a replaced value go (`tables.RESTING`).
    The result is validated before it replaces the files.
    """
    _require_readable(plan)
    if not plan.edits:
        return plan
    held = load_texts((_TABLE, "counts", *RESTING), folder)
    counts = [dict(row) for row in held.counts]
    changed: dict[str, Rows] = {_TABLE: _edited(held.attributes, plan, _authors_doi(tables))}
    for table, names in RESTING.items():
        gone = {(entry.study, entry.value) for entry in plan.withdrawn if entry.table == table}
        if gone:
            changed[table] = [
                row
                for row in getattr(held, table)
                if (row["study"], " + ".join(row[name] for name in names)) not in gone
            ]
            for row in counts:
                if row["table"] == table and not row["column"]:
                    row["held"] = str(len(changed[table]))
            changed["counts"] = counts
    write_valid(folder, changed)
    return plan.model_copy(update={"written": len(plan.edits)})


def _authors_doi(tables: SurveyTables) -> str:
    references = tables.references
    return str(references.loc[references["role"] == "dataset", "doi"].iloc[0])


def _edited(rows: Rows, plan: ImportPlan, doi: str) -> list[Mapping[str, str]]:
    """Return the rows of attributes.csv with the plan's cells replaced where they stand."""
    held: dict[str, dict[str, list[Mapping[str, str]]]] = {}
    for row in rows:
        held.setdefault(row["study"], {}).setdefault(row["attribute"], []).append(row)
    for edit in plan.edits:
        of_study = held[edit.study]
        of_study[edit.attribute] = list(_rows_of(edit, of_study.get(edit.attribute, []), doi))
    return [row for study in held.values() for cell in study.values() for row in cell]


def _rows_of(edit: Difference, replaced: Rows, doi: str) -> Iterator[dict[str, str]]:
    taken = {"basis": AUTHORS_BASIS, "source": doi}
    if edit.kind == "confirmed":
        for row in replaced:
            source = f" ({row['source']})" if row["source"] else ""
            said = f"also {row['basis']}{source}"
            yield {**row, **taken, "note": ": ".join(filter(None, (said, row["note"])))}
        return
    before = ", ".join(edit.ours)
    note = f"before: {before} ({edit.basis})" if before else ""
    for value in edit.theirs:
        at = {"study": edit.study, "attribute": edit.attribute, "value": value}
        yield {**at, **taken, "note": note}
