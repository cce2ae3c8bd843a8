"""`sunatlas benchmark`: pipelines scored on the standard data sets."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli.measuring import AVAILABLE_WORKERS, ManyWorkersOption, StoreOption, scored
from api.cli.tables import Format, FormatOption, emit
from benchmark.metrics.score import METRICS
from benchmark.plan.combinations import cells, incompatible

app = typer.Typer(add_completion=False, rich_markup_mode=None)

COLUMNS = (
    *("dataset", "condition", "extractor", "model", "rms_deg", "bound_deg", "over_bound"),
    *(
        "bound_unit_deg",
        "over_bound_unit",
        "floor_deg",
        "availability",
        "false_sun",
        "latency_us",
        "status",
    ),
)
CSV_COLUMNS = (
    *("dataset", "condition", "detector", "mask", "extractor", "model", "status", "reason"),
    *("n_calibration", "n_test", "n_observable", *METRICS, "latency_us", "time_ratio"),
)


@app.command()
def benchmark(
    *,
    dataset: Annotated[
        list[str] | None, typer.Option(help="Only this data set; may be repeated.")
    ] = None,
    condition: Annotated[
        list[str] | None, typer.Option(help="Only this condition; may be repeated.")
    ] = None,
    extractor: Annotated[
        list[str] | None,
        typer.Option(help="Only this implementation of an extractor; may be repeated."),
    ] = None,
    model: Annotated[
        list[str] | None,
        typer.Option(help="Only this implementation of a model; may be repeated."),
    ] = None,
    workers: ManyWorkersOption = AVAILABLE_WORKERS,
    store: StoreOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Score pipelines on the standard datasets.

    Every compatible combination of the named things, or of all there are. Cells that the
    published results hold are read there; others are measured into the working store (see
    --store) and not measured again, also after the run was broken off.
    """
    planned = cells(dataset or None, condition or None, extractor or None, model or None)
    result = scored(planned, workers, store)
    columns = CSV_COLUMNS if form is Format.CSV else COLUMNS
    document = {"scores": result.rows, "sources": result.sources()}
    emit(result.rows, columns, form, document=document, title=f"{len(result.rows)} scores")
    for warning in result.warnings:
        typer.echo(f"warning: {warning}", err=True)
    typer.echo(
        f"{result.published} published, {result.kept} measured before, {result.measured} measured "
        f"now; new results are kept in {result.directory}",
        err=True,
    )
    if not planned:
        refused = incompatible(dataset or None, extractor or None, model or None)
        reason = f": {refused[0].reason}" if refused else ""
        typer.echo(f"sunatlas: no compatible combination of these names{reason}", err=True)
        raise typer.Exit(1)
