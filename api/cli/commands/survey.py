"""`sunatlas survey`: the facts checked against the survey, and the authors' own table taken in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import typer

import survey_data
from api.cli.commands import survey_add
from api.cli.commands.survey_import import DataOption, import_
from api.cli.table_output import Format, FormatOption, emit, emit_json, say
from survey_data import FidelityReport, Problem, facts_manifest, labels
from survey_data.descriptor import DATA_DIRECTORY

app = typer.Typer(add_completion=False, rich_markup_mode=None)
app.command("import")(import_)
app.command("add")(survey_add.add)
app.command("remove")(survey_add.remove)
app.command("verify")(survey_add.verify)

FINDINGS = (
    *("id", "verdict", "clause_verdict", "counted", "given", "expects", "most_frequent"),
    "settled_by",
)
FINDINGS_CSV = (
    *("id", "verdict", "clause", "clause_verdict", "kind", "survey_section"),
    *("section_name", "given", "expects"),
    *("matching", "counted", "named", "ranking", "settled_by", "clause_statement", "statement"),
    *("not_tested",),
)


@app.command()
def check(*, data: DataOption = None, form: FormatOption = Format.TABLE) -> None:
    """Validate the tables of the survey and compare them with its findings.

    Reports counts, completeness of each attribute by basis, contradictions between a study's number
    and its accuracy class, and a verdict for each finding of the survey. CSV has one row per clause
    of a finding. Problems are named on stderr with file, row and column, and the exit code is 1.
    """
    problems = [*survey_data.validate(data), *facts_manifest.changes(data or DATA_DIRECTORY)]
    if problems:
        _refuse(problems, form)
    report = survey_data.fidelity(survey_data.load(data))
    if form is Format.JSON:
        emit_json(report.to_dict())
    elif form is Format.CSV:
        emit(_clauses(report), FINDINGS_CSV, form)
    else:
        _print(report)


def _clauses(report: FidelityReport) -> list[dict[str, Any]]:
    """Return a row for each clause, with what is said of its finding as a whole."""
    return [
        {
            **clause.to_dict(),
            "clause_verdict": clause.verdict,
            "clause_statement": clause.statement,
            **{name: getattr(found, name) for name in ("id", "verdict", "statement")},
            **{name: getattr(found, name) for name in ("survey_section", "not_tested")},
            "section_name": labels.name(found.survey_section),
        }
        for found in report.findings
        for clause in found.clauses
    ]


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
    bases = list(dict.fromkeys(basis for c in report.completeness.values() for basis in c.by_basis))
    emit(
        [
            {
                "attribute": attribute,
                "known": c.known,
                "unknown": c.unknown,
                **{basis: c.by_basis.get(basis, 0) for basis in bases},
            }
            for attribute, c in report.completeness.items()
        ],
        ("attribute", "known", "unknown", *bases),
        Format.TABLE,
        title="Studies with a known value, by its strongest basis",
    )
    typer.echo()
    against = [
        f"{one.study} ({one.accuracy_deg:g} deg, filed as {one.filed}, by limits {one.by_limits})"
        for one in report.class_disagreements
    ]
    say(
        f"Printed classes or numbers that the limits of the classes contradict: {len(against)}"
        f"{': ' if against else ''}{', '.join(against)}."
    )
    typer.echo()
    verdicts = ", ".join(f"{count} {verdict}" for verdict, count in report.verdicts.items())
    emit(
        [
            {**row, "most_frequent": [f"{value} {count}" for value, count in row["ranking"][:3]]}
            for row in _clauses(report)
        ],
        FINDINGS,
        Format.TABLE,
        title=f"{len(report.findings)} findings: {verdicts}",
    )
