"""`sunatlas survey import`: the authors' table, or their bibliography, compared and taken over."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import BaseModel

import survey_data
from api.cli.table_output import Format, FormatOption, emit, emit_json, say
from api.cli.wrong_call import WrongCallError
from survey_data import ImportPlan
from survey_data.importing.bibliography import SUFFIXES

IDENTITIES = ("study", "column", "kind", "identity", "ours", "theirs", "line")
CELLS = ("study", "attribute", "kind", "ours", "theirs", "basis", "row", "column")


def import_(
    file: Annotated[
        Path,
        typer.Argument(
            help="CSV or XLSX table of studies, or the survey's bibliography (.bib, .ris)."
        ),
    ],
    *,
    replace: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY", help="Study whose confirmed identity may be replaced; may be repeated."
        ),
    ] = None,
    mapped: Annotated[
        list[str] | None,
        typer.Option(
            "--map",
            metavar="COL=ATTRIBUTE",
            help="Attribute of a column: study, title, authors, year or another attribute; - "
            "ignores it; may be repeated. Other columns are matched by their names.",
        ),
    ] = None,
    sheet: Annotated[str | None, typer.Option(help="Sheet of the workbook.")] = None,
    apply: ApplyOption = False,
    data: DataOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Compare a table or bibliography with the Atlas, and import it with --apply.

    Shows how each column was read and every cell that differs: new (unknown here), changed,
    confirmed (same value, better evidence) or conflict (the value here is printed in the survey and
    stays). Values that depend on a replaced value are listed and removed. Unreadable cells are
    named on stderr with row and column, and the exit code is 1. From a bibliography title, authors,
    venue, type, DOI and address are taken; a confirmed identity is replaced only with --replace.
    """
    if file.suffix.casefold() in SUFFIXES:
        if mapped or sheet:
            raise WrongCallError("--map and --sheet are of a table, not of a bibliography")
        _bibliography(file, replace or (), data, form, apply=apply)
        return
    if replace:
        raise WrongCallError("--replace is of a bibliography, not of a table")
    plan = survey_data.import_table(
        file, data, overrides=_overrides(mapped or ()), sheet=sheet, apply=apply
    )
    if form is Format.JSON:
        emit_json(plan.model_dump(mode="json"))
    elif form is Format.CSV:
        emit(_rows((*plan.differences, *plan.confirmed)), CELLS, form)
    else:
        _print(plan)
    for problem in plan.errors:
        typer.echo(f"sunatlas: {problem}", err=True)
    if plan.errors:
        raise typer.Exit(1)


def _bibliography(
    file: Path, replaced: Sequence[str], data: Path | None, form: Format, *, apply: bool
) -> None:
    """Compare a bibliography with the table of studies."""
    plan = survey_data.import_bibliography(file, data, replace_studies=replaced, apply=apply)
    rows = _rows(plan.differences)
    title = f"{len(rows)} cells of studies that {plan.source} says otherwise"
    emit(rows, IDENTITIES, form, document=plan.model_dump(mode="json"), title=title)
    if form is not Format.TABLE:
        return
    if plan.conflicts:
        keys = ", ".join(plan.conflicts)
        say(f"confirmed and said otherwise: {keys}; --replace KEY takes what the file says")
    for kept in (found for found in plan.differences if found.kind == "kept"):
        say(f"{kept.study}: published in {kept.theirs} there; the year of the key stays")
    for aside in plan.left_aside:
        say(f"left aside: {aside.key}: {aside.reason}")
    if plan.missing:
        say(f"{len(plan.missing)} studies are not in it: {', '.join(plan.missing)}")
    many = "identity" if len(plan.settled) == 1 else "identities"
    what = f"{len(plan.edits)} cells and {len(plan.settled)} {many}"
    if apply and (plan.edits or plan.settled):
        typer.echo(f"{what} written.")
    elif plan.edits or plan.settled:
        typer.echo(f"Nothing written; --apply writes {what}.")
    else:
        typer.echo("Nothing written.")


def _rows(differences: Sequence[BaseModel]) -> list[dict[str, Any]]:
    return [difference.model_dump(mode="json") for difference in differences]


def _overrides(mapped: Sequence[str]) -> dict[str, str]:
    """Read COL=ATTRIBUTE; the last = divides, so that a column's name may hold one."""
    overrides: dict[str, str] = {}
    for text in mapped:
        column, equals, target = text.rpartition("=")
        if not (equals and column and target):
            raise WrongCallError(f"--map: expected COL=ATTRIBUTE; got {text!r}")
        if overrides.setdefault(column, target) != target:
            raise WrongCallError(
                f"--map: column {column!r} is given both {overrides[column]!r} and {target!r}"
            )
    return overrides


def _print(plan: ImportPlan) -> None:
    listed = plan.model_dump(mode="json")
    mapping = listed["mapping"]
    emit(mapping["matches"], ("column", "target"), Format.TABLE, title=f"Columns of {plan.source}")
    if mapping["ignored"]:
        say(f"left aside: {', '.join(mapping['ignored'])}")
    cells = [*listed["differences"], *listed["confirmed"]]
    emit(cells, CELLS, Format.TABLE, title=f"{len(cells)} cells that differ")
    if listed["withdrawn"]:
        title = "Rows of ours that rest on a replaced value, and go with it"
        emit(listed["withdrawn"], ("table", "study", "value", "note"), Format.TABLE, title=title)
    if listed["unmatched"]:
        emit(listed["unmatched"], ("row", "reason"), Format.TABLE, title="Rows left aside")
    edits = len(plan.edits)
    if plan.written:
        typer.echo(f"{plan.written} cells written.")
    elif edits and not plan.errors:
        typer.echo(f"Nothing written; --apply writes {edits} cells.")
    else:
        typer.echo("Nothing written.")


DataOption = Annotated[
    Path | None, typer.Option(help="Directory of the tables; by default those of the Atlas.")
]
ApplyOption = Annotated[
    bool, typer.Option("--apply", help="Write the changes; otherwise only show them.")
]
