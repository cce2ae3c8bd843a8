"""`sunatlas run`: what a study did, run on the data of its architecture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

import typer

from api.cli.asking import ask, knowledge
from api.cli.measuring import Scored, StoreOption, WorkersOption, scored
from api.cli.tables import Format, FormatOption, emit
from api.http.routers import studies
from benchmark.contract import Cell, UnknownNameError
from benchmark.metrics.score import METRICS
from benchmark.plan.combinations import cells
from registry.resolution import Resolution

app = typer.Typer(add_completion=False, rich_markup_mode=None)

COLUMNS = (
    *("dataset", "condition", "extractor", "model", "rms_deg", "bound_deg", "over_bound"),
    *(
        "bound_unit_deg",
        "over_bound_unit",
        "floor_deg",
        "availability",
        "false_sun",
        "status",
        "assumed",
    ),
)
CSV_COLUMNS = (
    *("study", "dataset", "condition", "detector", "mask", "extractor", "model", "status"),
    *("reason", "n_calibration", "n_test", "n_observable", *METRICS, "latency_us", "assumed"),
)


@app.command()
def run(
    study: Annotated[str, typer.Argument(help="Key of the study, such as Chang2008.")],
    *,
    condition: Annotated[
        list[str] | None, typer.Option(help="Only this condition; may be repeated.")
    ] = None,
    workers: WorkersOption = 1,
    store: StoreOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Run a study's pipelines on the data of its architecture.

    Every pipeline that the study's mapping resolves to is scored on every data set of its detector
    and mask that it fits; assumed says what the study does not state, and by what rule it stands
    there; bound is the Cramer-Rao bound with the unit known, over bound the error
    divided by it; bound unit and over bound unit are those with the unit unknown but for flat and
    dark readings, and floor adds the systematic error of the calibration's reference: precision
    and accuracy are two numbers. What does not run as the study states it is a gap: listed on
    stderr, and in JSON under "gaps". Where nothing runs, the exit code is 1.

    Cells that the published results hold are read there. Others are measured into the working
    store (see --store) and not measured again.
    """
    ask(studies.study, key=study)  # refuses an unknown key with the nearest one
    resolution = knowledge().resolutions[study]
    planned = _planned(resolution, condition)
    result = scored(planned, workers, store)
    rows = [{"study": study, **row, "assumed": planned[_cell(row)]} for row in result.rows]
    _print(study, resolution, rows, result, form)
    if not rows:
        typer.echo(f"sunatlas: nothing of {study} runs yet; its gaps are listed above", err=True)
        raise typer.Exit(1)


def _planned(resolution: Resolution, conditions: Sequence[str] | None) -> dict[Cell, list[str]]:
    """Return the study's cells, each with what is assumed where the study does not say."""
    presets = {name for pipeline in resolution.pipelines for name in pipeline.datasets}
    everything = [cell for name in presets for cell in cells(name)]
    known = {cell.condition for cell in everything}
    for name in conditions or ():
        if known and name not in known:
            raise UnknownNameError("condition", name, known)
    wanted = set(conditions or known)
    planned: dict[Cell, list[str]] = {}
    for pipeline in resolution.pipelines:
        assumed = [f"{attribute}: {rule}" for attribute, rule in pipeline.assumed.items()]
        for cell in everything:
            ours = cell.dataset in pipeline.datasets and cell.condition in wanted
            if ours and (cell.extractor, cell.model) == (pipeline.extractor, pipeline.model):
                # A pipeline that the study states outright is not an assumption.
                planned[cell] = [] if planned.get(cell) == [] else assumed
    return planned


def _cell(row: dict[str, Any]) -> Cell:
    return Cell(row["dataset"], row["condition"], row["extractor"], row["model"])


def _print(
    study: str,
    resolution: Resolution,
    rows: list[dict[str, Any]],
    result: Scored,
    form: Format,
) -> None:
    gaps = [gap.to_dict() for gap in resolution.gaps]
    document = {
        "study": study,
        "state": resolution.state,
        "scores": rows,
        "gaps": gaps,
        "sources": result.sources(),
    }
    title = f"{study} ({resolution.state}): {len(rows)} scores"
    columns = CSV_COLUMNS if form is Format.CSV else COLUMNS
    emit(rows, columns, form, document=document, title=title)
    for warning in result.warnings:
        typer.echo(f"warning: {warning}", err=True)
    if form is not Format.JSON:
        for gap in gaps:
            typer.echo(f"gap: {gap['attribute']} {gap['value']}: {gap['reason']}", err=True)
    if result.measured or result.kept:
        typer.echo(
            f"{result.published} published, {result.kept} measured before, {result.measured} "
            f"measured now; kept in {result.directory}",
            err=True,
        )
