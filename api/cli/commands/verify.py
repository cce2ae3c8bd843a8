"""`sunatlas verify`: published cells drawn at random, measured again and compared."""

from __future__ import annotations

import secrets
from dataclasses import asdict
from typing import Annotated

import typer

from api.cli.measuring import (
    AVAILABLE_WORKERS,
    ManyWorkersOption,
    SchedulerOption,
    SuiteOption,
    stores_of,
)
from api.cli.table_output import Format, FormatOption, emit
from api.cli.wrong_call import WrongCallError
from benchmark.running.experiment import draw_cells
from benchmark.suites.planning import cells_of
from benchmark.suites.selection import suite as suite_named
from benchmark.suites.verification import verify as verified

COLUMNS = ("file", "cell", "committed", "measured")


def verify(
    *,
    sample: Annotated[
        int | None,
        typer.Option(min=1, help="Number of cells; by default 10, or all cells of --suite."),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="Seed of the random sample; by default a new one.")
    ] = None,
    suite: SuiteOption = None,
    workers: ManyWorkersOption = AVAILABLE_WORKERS,
    scheduler: SchedulerOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Measure a random sample of published cells again.

    Results must agree digit for digit with the published ones. Differences that another processor
    may cause are counted; all others are printed with file and cell, and the exit code is 1.
    Nothing is written.
    """
    if suite is not None and sample is None and seed is not None:
        raise WrongCallError("--suite without --sample takes every cell: --seed draws none")
    record, _ = stores_of(None)
    published = record.scores()
    if not published:
        raise WrongCallError(f"nothing is published in {record.directory}")
    if suite is not None:
        chosen = frozenset(cells_of(suite_named(suite), [record]))
        published = {cell: row for cell, row in published.items() if cell in chosen}
    number = secrets.randbelow(10**6) if seed is None else seed
    count = sample or (len(published) if suite else 10)
    cells = draw_cells(published, count, number)
    typer.echo(f"{len(cells)} of {len(published)} cells, drawn by --seed {number}", err=True)
    result = verified(cells, record, workers, scheduler=scheduler)
    rows = [
        {name: getattr(difference, name) for name in COLUMNS} for difference in result.differences
    ]
    if rows or form is not Format.TABLE:
        document = {
            "seed": number,
            "cells": [asdict(cell) for cell in result.cells],
            "alike": result.alike,
            "differences": rows,
        }
        emit(rows, COLUMNS, form, document=document, title=f"{len(rows)} differences")
    typer.echo(f"{result.alike} of {len(cells)} cells are alike to the last digit", err=True)
    if rows:
        first = result.differences[0]
        typer.echo(f"sunatlas: {len(rows)} differences, the first: {first}", err=True)
        raise typer.Exit(1)
    typer.echo("every published number that was drawn holds", err=True)
