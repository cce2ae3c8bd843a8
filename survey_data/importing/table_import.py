"""Taking over the survey authors' own table: reading, comparing, and writing when asked."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path

from files.csv_writing import csv_text
from survey_data.descriptor import DATA_DIRECTORY
from survey_data.importing.columns import match_columns
from survey_data.importing.plan import (
    AUTHORS_BASIS,
    Difference,
    ImportPlan,
    plan_import,
    require_readable,
)
from survey_data.importing.table_reader import read_table
from survey_data.importing.writing import locked_tables, rows_of, write_valid
from survey_data.tables import RESTING, SurveyTables, load

_TABLE = "attributes"


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
        Write. Without it nothing is written, and unreadable cells are listed in the plan's
        `errors` instead of raised. Applying the same table twice changes nothing the second time.

    Returns
    -------
    ImportPlan
        What would be written, or has been.

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


def _write(folder: Path, tables: SurveyTables, plan: ImportPlan) -> ImportPlan:
    """Write a plan's edits into tables that this process holds, all or nothing.

    A cell taken over gets the basis ``authors-table``; what it said before, and on what basis,
    stays in its note. Rows of other tables that rest on a replaced value go (`tables.RESTING`).
    The result is validated before it replaces the files.
    """
    require_readable(plan)
    if not plan.edits:
        return plan
    texts = {_TABLE: _edit(folder, plan, _authors_doi(tables))}
    counts: dict[str, int] = {}
    for table in sorted(RESTING):
        gone = {(entry.study, entry.value) for entry in plan.withdrawn if entry.table == table}
        if gone:
            texts[table], counts[table] = _without(folder, table, gone)
    if counts:
        texts["counts"] = _count(folder, counts)
    write_valid(folder, texts)
    return plan.model_copy(update={"written": len(plan.edits)})


def _authors_doi(tables: SurveyTables) -> str:
    references = tables.references
    return str(references.loc[references["role"] == "dataset", "doi"].iloc[0])


def _without(folder: Path, table: str, gone: set[tuple[str, str]]) -> tuple[str, int]:
    """Return a table without rows, given by study and value or pair, and how many are left."""
    header, rows = rows_of(folder, table)
    places = [header.index(name) for name in RESTING[table]]
    kept = [c for c in rows if (c[0], " + ".join(c[at] for at in places)) not in gone]
    return csv_text(header, kept), len(kept)


def _count(folder: Path, counts: Mapping[str, int]) -> str:
    """Return the text of counts.csv with the rows that tables have now."""
    header, rows = rows_of(folder, "counts")
    named, column, held = map(header.index, ("table", "column", "held"))
    for cells in rows:
        if not cells[column] and cells[named] in counts:
            cells[held] = str(counts[cells[named]])
    return csv_text(header, rows)


def _edit(folder: Path, plan: ImportPlan, doi: str) -> str:
    """Return the text of attributes.csv with the plan's cells replaced where they stand."""
    header, rows = rows_of(folder, _TABLE)
    held: dict[str, dict[str, list[list[str]]]] = {}
    for cells in rows:
        held.setdefault(cells[0], {}).setdefault(cells[1], []).append(cells)
    for edit in plan.edits:
        of_study = held[edit.study]
        of_study[edit.attribute] = _rows_of(edit, of_study.get(edit.attribute, []), doi)
    edited = [row for study in held.values() for cell in study.values() for row in cell]
    return csv_text(header, edited)


def _rows_of(edit: Difference, replaced: list[list[str]], doi: str) -> list[list[str]]:
    if edit.kind == "confirmed":
        return [
            [study, attribute, value, AUTHORS_BASIS, doi, _note(f"also {basis}", source, note)]
            for study, attribute, value, basis, source, note in replaced
        ]
    before = ", ".join(edit.ours)
    note = f"before: {before} ({edit.basis})" if before else ""
    return [[edit.study, edit.attribute, value, AUTHORS_BASIS, doi, note] for value in edit.theirs]


def _note(basis: str, source: str, note: str) -> str:
    said = f"{basis} ({source})" if source else basis
    return f"{said}: {note}" if note else said
