"""`sunatlas survey`: the facts checked against the survey, and the authors' own table taken in."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

import survey_data
from api.cli.commands import survey_add
from api.cli.commands.survey_import import import_
from api.cli.tables import Format, FormatOption, emit, emit_json, say
from survey_data import FidelityReport, Problem, recorded_facts
from survey_data.descriptor import DATA_DIRECTORY

app = typer.Typer(
    help="Check the survey's tables, import the authors' own, or add later studies.",
    add_completion=False,
    rich_markup_mode=None,
)
app.command("import")(import_)
app.command("add")(survey_add.add)
app.command("remove")(survey_add.remove)
app.command("verify")(survey_add.verify)

FINDINGS = ("id", "verdict", "counted", "given", "expects", "most_frequent", "settled_by")
FINDINGS_CSV = (
    *("id", "verdict", "kind", "survey_section", "given", "expects", "matching", "counted"),
    *("named", "ranking", "settled_by", "statement"),
)


@app.command()
def check(
    *,
    data: Annotated[
        Path | None,
        typer.Option(help="Directory of the tables; our own by default.", show_default=False),
    ] = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Validate the tables and report how faithful they are to the survey.

    Counts against the survey's own, completeness of every attribute by the basis of its values,
    and each of the survey's findings with a verdict and the counts behind it. CSV holds the
    findings. Where a table has problems, each is named on stderr with file, row and column, and
    the exit code is 1.
    """
    problems = [*survey_data.validate(data), *recorded_facts.changes(data or DATA_DIRECTORY)]
    if problems:
        _refuse(problems, form)
    report = survey_data.fidelity(survey_data.load(data))
    if form is Format.JSON:
        emit_json(report.to_dict())
    elif form is Format.CSV:
        emit([finding.to_dict() for finding in report.findings], FINDINGS_CSV, form)
    else:
        _print(report)


def _refuse(problems: Sequence[Problem], form: Format) -> None:
    if form is Format.JSON:
        emit_json({"problems": [problem.to_dict() for problem in problems]})
    for problem in problems:
        typer.echo(f"sunatlas: {problem}", err=True)
    raise typer.Exit(1)


def _print(report: FidelityReport) -> None:
    say(f"{report.studies} studies; the survey states {report.stated}.")
    say(report.explanation)
    typer.echo()
    emit(
        [
            {"count": c.id, "held": c.held, "stated": c.stated, "explanation": c.explanation}
            for c in report.counts
        ],
        ("count", "held", "stated", "explanation"),
        Format.TABLE,
        title="Counts",
    )
    typer.echo()
    bases = list(dict.fromkeys(basis for c in report.completeness for basis in c.by_basis))
    emit(
        [
            {
                "attribute": c.attribute,
                "known": c.known,
                "unknown": c.unknown,
                **{basis: c.by_basis.get(basis, 0) for basis in bases},
            }
            for c in report.completeness
        ],
        ("attribute", "known", "unknown", *bases),
        Format.TABLE,
        title="Studies with a known value, by its strongest basis",
    )
    typer.echo()
    verdicts = ", ".join(f"{count} {verdict}" for verdict, count in report.verdicts.items())
    emit(
        [
            {
                **finding.to_dict(),
                "most_frequent": [f"{value} {count}" for value, count in finding.ranking[:3]],
            }
            for finding in report.findings
        ],
        FINDINGS,
        Format.TABLE,
        title=f"{len(report.findings)} findings: {verdicts}",
    )
