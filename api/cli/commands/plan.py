"""`sunatlas plan`: what of a suite is to be measured, and why."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import typer

from api.cli.measuring import StoreOption, SuiteOption, every_store
from api.cli.table_output import Format, FormatOption, emit
from benchmark.suites.selection import suite as suite_named

if TYPE_CHECKING:
    from benchmark.contract import Cell
    from benchmark.suites.planning import CellPlan

COLUMNS = ("why", "dataset", "cells")
CSV_COLUMNS = ("dataset", "condition", "extractor", "model", "unit", "why")


def plan(
    *, suite: SuiteOption = "standard", store: StoreOption = None, form: FormatOption = Format.TABLE
) -> None:
    """List the cells that need measuring, with reasons.

    A cell is a pipeline on a data set under a condition. Listed are the cells that `sunatlas run
    --suite` would measure (by default suite standard): new ones, failed ones, and those whose data
    set, extractor, model or measuring code has changed. JSON and CSV list every cell. Nothing is
    measured.

    Below stands how much of each stage that is: data to generate, features to extract, models to
    fit, scores to compute. Stages in the cache of the local store are not computed again.
    """
    chosen = suite_named(str(suite))
    stores = every_store(store)
    from benchmark.suites.planning import cells_of  # noqa: PLC0415 - slow
    from benchmark.suites.planning import plan as planned_of  # noqa: PLC0415 - slow

    found = planned_of(cells_of(chosen, stores), stores)
    rows: list[dict[str, Any]] = [
        {**asdict(cell), "why": _why(cell, reasons)} for cell, reasons in found.missing.items()
    ]
    document = {
        "suite": chosen.name,
        "planned": len(found.cells),
        "missing": rows,
        "modules": list(found.modules),
        "stages": asdict(found.stages),
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
    typer.echo(f"{chosen.name}: {_summary(found)}", err=True)


def _why(cell: Cell, reasons: tuple[str, ...]) -> str:
    """Spell the reasons: what has changed, by name."""
    from benchmark.suites.planning import FAILED, NEW  # noqa: PLC0415 - slow

    if reasons in ((NEW,), (FAILED,)):
        return "new" if reasons == (NEW,) else "failed before"
    named = {"dataset": "data set", "extractor": cell.extractor, "model": cell.model}
    parts = [
        f"{what} {named[what]}" if what in ("extractor", "model") else named.get(what, what)
        for what in reasons
    ]
    return f"{', '.join(parts)} changed"


def _summary(found: CellPlan) -> str:
    count = f"{len(found.missing)} of {len(found.cells)} cells to be measured"
    if not found.missing:
        return count
    if found.modules:
        count += f"\nchanged modules: {', '.join(found.modules)}"
    todo = found.stages
    return (
        f"{count}\nby stage: data sets to generate {todo.data}, features to extract "
        f"{todo.features}, models to fit {todo.predictions}, scores to compute {todo.scores}"
    )
