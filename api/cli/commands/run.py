"""`sunatlas run`: what a study did, run on the data of its architecture, or a suite."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from api.cli.asking import ask, knowledge
from api.cli.commands import benchmark
from api.cli.measuring import (
    SchedulerOption,
    ScoredCells,
    StoreOption,
    SuiteOption,
    WorkersOption,
    every_store,
    say_sources,
    score_cells,
)
from api.cli.options import Asked, asked_by, complete
from api.cli.table_output import Format, FormatOption, emit
from api.cli.wrong_call import WrongCallError
from api.schema import words
from api.schema.scores import Score, ScoresQuery
from api.schema.table import columns_of
from api.service import studies
from benchmark.contract import Cell, UnknownNameError
from benchmark.plan.combinations import cells
from benchmark.plan.parts import every_part
from benchmark.suites.planning import cells_of
from benchmark.suites.selection import suite as suite_named
from registry.resolution import Resolution

COLUMNS = (*(name for name in benchmark.COLUMNS if name != "latency_us"), "assumed")
CSV_COLUMNS = ("study", *columns_of(Score), "assumed")

#: A suite may hold other units than the standard one.
SUITE_COLUMNS = ("unit", *benchmark.COLUMNS)


@asked_by(ScoresQuery, "condition")
def run(
    study: Annotated[
        str | None,
        typer.Argument(
            autocompletion=complete(words.StudyKey), help="Key of the study, such as Chang2008."
        ),
    ] = None,
    *,
    suite: SuiteOption = None,
    asked: Asked,
    workers: WorkersOption = 1,
    scheduler: SchedulerOption = None,
    store: StoreOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Run the pipelines of a study, or a suite.

    Each pipeline of the study is scored on every data set of its sensor. Columns: assumed lists
    what the study does not state, with the rule that fills it; bound is the Cramer-Rao bound for a
    known sensor unit; bound unit is the bound for a unit known only through its calibration; over
    bound is error divided by bound. Parts of the study that are not implemented are listed on
    stderr, and in JSON under "gaps". The exit code is 1 if nothing can run.

    Published results are reused if code and data are unchanged. New results are kept in the local
    store (see --store), so that an interrupted run can be continued.
    """
    if (study is None) == (suite is None):
        raise WrongCallError("one of a study's key and --suite is to be given")
    if study is None:
        if asked:
            raise WrongCallError("--condition goes with a study: a suite has its own")
        _run_suite(str(suite), workers, scheduler, store, form)
        return
    ask(studies.study, key=study)  # refuses an unknown key with the nearest one
    resolution = knowledge().of("all").resolutions[study]
    planned = _plan(resolution, asked.get("condition"))
    result = score_cells(planned, workers, store, scheduler)
    rows = [{"study": study, **row, "assumed": planned[_cell(row)]} for row in result.rows]
    _print(study, resolution, rows, result, form)
    if not rows:
        typer.echo(f"sunatlas: nothing of {study} runs yet; its gaps are listed above", err=True)
        raise typer.Exit(1)


def _run_suite(
    name: str, workers: int, scheduler: str | None, directory: Path | None, form: Format
) -> None:
    """Score a suite's cells, and those that follow from their scores."""
    chosen = suite_named(name)
    stores = every_store(directory)
    planned = cells_of(chosen, stores)
    result = score_cells(planned, workers, directory, scheduler)
    measured = result.measured_count
    while (now := cells_of(chosen, stores)) != planned:  # what follows from what was measured
        planned = now
        result = score_cells(planned, workers, directory, scheduler)
        measured += result.measured_count
    columns = columns_of(Score) if form is Format.CSV else SUITE_COLUMNS
    sources = {**result.sources(), "kept": result.stored_count - measured + result.measured_count}
    sources["measured"] = measured
    document = {"suite": name, "scores": result.rows, "sources": sources}
    emit(result.rows, columns, form, document=document, title=f"{name}: {len(result.rows)} scores")
    say_sources(result.published_count, sources["kept"], measured, result.directory)


def _plan(resolution: Resolution, conditions: Sequence[str] | None) -> dict[Cell, list[str]]:
    """Return the study's cells, each with what is assumed where the study does not say."""
    presets = {name for pipeline in resolution.pipelines for name in pipeline.datasets}
    everything = [cell for name in presets for cell in cells(name, parts=every_part())]
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
    result: ScoredCells,
    form: Format,
) -> None:
    gaps = [gap.to_dict() for gap in resolution.gaps]
    document = {
        "study": study,
        "grade": resolution.fidelity.grade,
        "sentence": resolution.fidelity.sentence,
        "state": resolution.state,
        "scores": rows,
        "gaps": gaps,
        "sources": result.sources(),
    }
    title = f"{study} ({resolution.fidelity.grade}): {len(rows)} scores"
    columns = CSV_COLUMNS if form is Format.CSV else COLUMNS
    emit(rows, columns, form, document=document, title=title)
    if form is not Format.JSON:
        typer.echo(f"{resolution.fidelity.grade}: {resolution.fidelity.sentence}", err=True)
    for warning in result.warnings:
        typer.echo(f"warning: {warning}", err=True)
    if form is not Format.JSON:
        for gap in gaps:
            typer.echo(f"gap: {gap['attribute']} {gap['value']}: {gap['reason']}", err=True)
    if result.measured_count or result.stored_count:
        typer.echo(
            f"{result.published_count} published, {result.stored_count} measured before, "
            f"{result.measured_count} measured now; kept in {result.directory}",
            err=True,
        )
