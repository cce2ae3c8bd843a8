"""`sunatlas plan`: what of a suite is to be measured, why, and how long it takes."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict
from typing import Any

import typer

from api.cli.measuring import (
    AVAILABLE_WORKERS,
    ManyWorkersOption,
    StoreOption,
    SuiteOption,
    stores_of,
)
from api.cli.table_output import Format, FormatOption, emit
from benchmark.contract import Cell
from benchmark.running.durations import Estimate
from benchmark.suites.planning import FAILED, NEW, CellPlan, cells_of
from benchmark.suites.planning import plan as planned_of
from benchmark.suites.selection import suite as suite_named

app = typer.Typer(add_completion=False, rich_markup_mode=None)

COLUMNS = ("why", "dataset", "cells")
CSV_COLUMNS = ("dataset", "condition", "extractor", "model", "unit", "why")


@app.command()
def plan(
    *,
    suite: SuiteOption = "standard",
    workers: ManyWorkersOption = AVAILABLE_WORKERS,
    store: StoreOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """List the cells that need measuring, with reasons.

    A cell is a pipeline on a data set under a condition. Listed are the cells that `sunatlas run
    --suite` would measure (by default suite standard): new ones, failed ones, and those whose data
    set, extractor, model or measuring code has changed. The time is estimated from earlier runs on
    this machine. Nothing is measured. JSON and CSV list every cell.

    Below stands how much of each stage that is: data to generate, features to extract, models to
    fit, scores to compute. What is kept beside the local store is not done again.
    """
    chosen = suite_named(str(suite))
    stores = stores_of(store)
    found = planned_of(cells_of(chosen, stores), stores)
    rows: list[dict[str, Any]] = [
        {**asdict(cell), "why": _why(cell, reasons)} for cell, reasons in found.missing.items()
    ]
    document = {
        "suite": chosen.name,
        "planned": len(found.cells),
        "missing": rows,
        "stages": asdict(found.stages),
        "estimate": {**asdict(found.estimate), "workers": workers},
    }
    if form is Format.TABLE:
        counted = Counter((row["why"], row["dataset"]) for row in rows)
        table = [
            {"why": why, "dataset": dataset, "cells": count}
            for (why, dataset), count in sorted(counted.items())
        ]
        if table:
            emit(table, COLUMNS, form, title=f"{chosen.name}: to be measured")
    else:
        emit(rows, CSV_COLUMNS, form, document=document)
    typer.echo(f"{chosen.name}: {_summary(found, workers)}", err=True)


def _why(cell: Cell, reasons: tuple[str, ...]) -> str:
    """Spell the reasons: what has changed, by name."""
    if reasons in ((NEW,), (FAILED,)):
        return "new" if reasons == (NEW,) else "failed before"
    named = {"dataset": "data set", "extractor": cell.extractor, "model": cell.model}
    told = [
        f"{what} {named[what]}" if what in ("extractor", "model") else named.get(what, what)
        for what in reasons
    ]
    return f"{', '.join(told)} changed"


def _summary(found: CellPlan, workers: int) -> str:
    count = f"{len(found.missing)} of {len(found.cells)} cells to be measured"
    if not found.missing:
        return count
    todo = found.stages
    stages = (
        f"{todo.data} data sets to generate, {todo.features} features to extract, "
        f"{todo.predictions} models to fit, {todo.scores} scores to compute"
    )
    return f"{count}: {stages}; {_time(found.estimate, workers)}"


def _time(estimate: Estimate, workers: int) -> str:
    if estimate.unknown == estimate.tasks:
        return "how long that takes is known here once it has been run"
    known = f"about {estimate.seconds / workers:.2g} s on {workers} workers"
    rest = f", and {estimate.unknown} of {estimate.tasks} tasks whose like never ran here"
    return known + (rest if estimate.unknown else "")
