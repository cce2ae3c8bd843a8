"""`sunatlas assess`: the survey's scores of its methods beside the measured ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer
from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from api.cli.asking import ask
from api.cli.tables import Format, FormatOption, console, emit
from api.http.routers.assessment import assessment
from benchmark.assessment.definitions import DEFINITIONS

app = typer.Typer(add_completion=False, rich_markup_mode=None)

COLUMNS = (
    *("method", "taxonomy", "case_study", "property", "survey", "measured", "agreement"),
    *("value", "unit", "extractor", "measured_on", "reason"),
)
_MARKS = {"agrees": "=", "near": "~", "opposed": "x", "not judged": ".", "not measured": "-"}


@app.command()
def assess(
    *,
    method: Annotated[
        list[str] | None,
        typer.Option(help="Only this method of the table, a row a property; repeatable."),
    ] = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Show the survey's scores of extractors beside measured ones.

    19 methods in 21 properties, scored 2 (provides), 1 (partly) or 0 (does not). A cell shows the
    survey's score, a mark and the measured one: = agrees, ~ one apart, x opposed; a dot where
    nothing measured can contradict the survey, a dash where it is not measured. Read from the
    published results, nothing is measured now; definitions and limits stand in docs/assessment.md.
    CSV has a row a method and property.
    """
    answer = ask(assessment, {"method": method})
    document = answer.document
    if form is not Format.TABLE or method:
        emit(answer.rows(), COLUMNS, form, document=document)
        return
    table = Table(
        title="Survey, mark and measured, by property",
        title_justify="left",
        box=SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
    )
    table.add_column("method", no_wrap=True)
    for number in range(1, len(DEFINITIONS) + 1):
        table.add_column(str(number), no_wrap=True)
    for mark in _MARKS.values():
        table.add_column(mark, justify="right", no_wrap=True)
    for row in document["methods"]:
        cells = [_cell(verdict) for verdict in row["properties"]]
        counts = [str(count) for count in row["counts"].values()]
        table.add_row(*(Text(text) for text in (row["method"], *cells, *counts)))
    out = console()
    out.width = max(out.width, 150)  # a row broken over two lines cannot be compared
    out.print(table)
    for number, name in enumerate(DEFINITIONS, start=1):
        typer.echo(f"{number:>2} {name}")
    totals = document["totals"]
    typer.echo("; ".join(f"{name}: {count}" for name, count in totals.items()), err=True)


def _cell(verdict: Mapping[str, Any]) -> str:
    measured = verdict["measured"]
    if measured is None:
        return f"{verdict['survey']} {_MARKS[verdict['agreement']]}"
    return f"{verdict['survey']}{_MARKS[verdict['agreement']]}{measured}"
