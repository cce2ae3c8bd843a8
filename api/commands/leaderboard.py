"""`sunatlas leaderboard`: the published results, brought up to date or checked."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from api.commands.asking import WrongCallError
from api.commands.measuring import AVAILABLE_WORKERS, ManyWorkersOption, interruptible
from api.commands.tables import Format, FormatOption, emit
from benchmark import leaderboard as published
from benchmark.store import PUBLISHED

app = typer.Typer(add_completion=False, rich_markup_mode=None)

COLUMNS = (
    *("dataset", "condition", "rank", "extractor", "model", "rms_deg", "bound_deg", "over_bound"),
    *("found_fraction", "time_ratio"),
)
DIFFERENCES = ("file", "cell", "committed", "measured")


@app.command()
def leaderboard(
    *,
    check: Annotated[
        bool,
        typer.Option("--check", help="Write nothing; measure everything again and compare."),
    ] = False,
    stored: Annotated[
        bool,
        typer.Option("--stored", help="With --check: compare what is stored, measure nothing."),
    ] = False,
    workers: ManyWorkersOption = AVAILABLE_WORKERS,
    form: FormatOption = Format.TABLE,
) -> None:
    """Bring the published leaderboard up to date, or check it.

    Measures the cells whose code or data have changed, and only those, then writes the results
    and leaderboard.{json,csv,md,html} beside them and prints the best of each data set and
    condition. With --check every committed number is compared with what the code gives now, a
    difference is printed with its file and cell, and the exit code is 1; times are not compared.
    """
    if check:
        _check(workers, form, stored_only=stored)
    elif stored:
        raise WrongCallError("--stored goes with --check")
    else:
        _update(workers, form)


def _check(workers: int, form: Format, *, stored_only: bool) -> None:
    with interruptible():
        found = published.check(PUBLISHED, workers, stored_only=stored_only)
    rows = [{name: getattr(difference, name) for name in DIFFERENCES} for difference in found]
    if rows or form is not Format.TABLE:
        emit(rows, DIFFERENCES, form, title=f"{len(rows)} differences")
    if found:
        typer.echo(f"sunatlas: {len(found)} differences, the first: {found[0]}", err=True)
        raise typer.Exit(1)
    how = "the files agree with each other and the code" if stored_only else "measured again"
    typer.echo(f"every published number holds: {how}", err=True)


def _update(workers: int, form: Format) -> None:
    with interruptible():
        summary = published.update(PUBLISHED, workers)
    board = json.loads((PUBLISHED / "leaderboard.json").read_text())
    best = [row for dataset in board["datasets"] for row in dataset["rows"] if row["rank"] == 1]
    emit(best, COLUMNS, form, document=board, title="Best of each data set and condition")
    for cell, reason in summary.failed:
        typer.echo(f"failed: {cell}: {reason}", err=True)
    for warning in summary.warnings:
        typer.echo(f"warning: {warning}", err=True)
    typer.echo(
        f"{summary.planned} cells, {summary.computed} measured in {summary.seconds:.1f} s, "
        f"{summary.already_stored} stored before; in {summary.store}",
        err=True,
    )
