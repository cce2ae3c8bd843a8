"""`sunatlas benchmark`: pipelines scored on the standard data sets."""

from __future__ import annotations

from collections.abc import Sequence

import typer

from api.cli.measuring import (
    AVAILABLE_WORKERS,
    ManyWorkersOption,
    SchedulerOption,
    StoreOption,
    score_cells,
)
from api.cli.options import Asked, asked_by
from api.cli.table_output import Format, FormatOption, emit
from api.schema.scores import Score, ScoresQuery
from api.schema.table import columns_of
from benchmark.plan.combinations import Incompatible, cells, incompatible

app = typer.Typer(add_completion=False, rich_markup_mode=None)

COLUMNS = (
    *("dataset", "condition", "extractor", "model", "rms_deg", "bound_deg", "over_bound"),
    *(
        "bound_unit_deg",
        "over_bound_unit",
        "availability",
        "false_sun",
        "latency_us",
        "status",
    ),
)


@app.command()
@asked_by(ScoresQuery, "dataset", "condition", "extractor", "model")
def benchmark(
    *,
    asked: Asked,
    workers: ManyWorkersOption = AVAILABLE_WORKERS,
    scheduler: SchedulerOption = None,
    store: StoreOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Score pipelines on the standard data sets.

    Runs every compatible combination of the given data sets, conditions, extractors and models;
    without options, all. Published results are reused if code and data are unchanged. New results
    are kept in the local store (see --store), so that an interrupted run can be continued.
    """
    names = {f"{name}s": given for name, given in asked.items()}
    planned = cells(**names)
    if not planned:
        names.pop("conditions", None)
        refused = incompatible(**names)
        typer.echo(f"sunatlas: no compatible combination of these names{_why(refused)}", err=True)
        raise typer.Exit(1)
    result = score_cells(planned, workers, store, scheduler)
    columns = columns_of(Score) if form is Format.CSV else COLUMNS
    document = {"scores": result.rows, "sources": result.sources()}
    emit(result.rows, columns, form, document=document, title=f"{len(result.rows)} scores")
    for warning in result.warnings:
        typer.echo(f"warning: {warning}", err=True)
    typer.echo(
        f"{result.published} published, {result.kept} measured before, {result.measured} measured "
        f"now; new results are kept in {result.directory}",
        err=True,
    )


def _why(refused: Sequence[Incompatible]) -> str:
    """Say why the first combination is none."""
    if not refused:
        return ""
    first = refused[0]
    names = " + ".join(name for name in (first.extractor, first.model) if name)
    return f": {first.dataset}, {names}: {first.reason}"
