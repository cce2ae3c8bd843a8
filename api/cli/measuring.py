"""Measuring cells for a command: where results are looked up, where new ones go.

A cell that the published results hold for the code and data as they are is read there. Any other
is measured once into the working store (`api.user_cache`), a directory of the same files,
and read from it the next time.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from api.cli.options import complete
from api.schema.parameters import OneOf
from api.user_cache import user_cache
from benchmark.contract import Cell
from benchmark.results.store import PUBLISHED, PUBLISHED_STUDIES, Store
from benchmark.results.times import read_times
from benchmark.suites.selection import SUITES

Row = dict[str, Any]


def _available_workers() -> int:
    """Return the number of processors this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


AVAILABLE_WORKERS = _available_workers()

WorkersOption = Annotated[
    int, typer.Option(min=1, help="Number of processes; does not change the results.")
]
ManyWorkersOption = Annotated[
    int,
    typer.Option(
        min=1,
        help="Number of processes; does not change the results.",
        show_default="number of processors",
    ),
]
StoreOption = Annotated[
    Path | None,
    typer.Option(
        help="Local store for new results; by default $SUNATLAS_STORE or the user's cache "
        "directory.",
        file_okay=False,
    ),
]
SchedulerOption = Annotated[
    str | None,
    typer.Option(
        help="Address of a Dask scheduler, such as tcp://127.0.0.1:8786; needs the extra 'cluster'."
    ),
]
SuiteOption = Annotated[
    str | None,
    typer.Option(
        autocompletion=complete(OneOf(lambda: tuple(SUITES))),
        help=f"A suite: {'; '.join(f'{suite.name} ({suite.what})' for suite in SUITES.values())}.",
        show_default=False,
    ),
]


def stores_of(directory: Path | None) -> tuple[Store, Store]:
    """Return the published results and the working store: where cells are looked up, in order."""
    return Store(PUBLISHED), Store(directory or user_cache())


def every_store(directory: Path | None) -> tuple[Store, Store, Store]:
    """Return as `stores_of`, with the published results of the sensors of single studies."""
    published, work = stores_of(directory)
    return published, Store(PUBLISHED_STUDIES), work


@dataclass(frozen=True)
class ScoredCells:
    """Rows of cells and where they came from.

    Attributes
    ----------
    rows : score rows in the order of the cells, with latency_us and time_ratio as published
    published_count, stored_count, measured_count : numbers of scores read from the published
        results, read from the working store, and measured now
    directory : the working store
    warnings : of the runner
    """

    rows: list[Row]
    published_count: int
    stored_count: int
    measured_count: int
    directory: Path
    warnings: tuple[str, ...]

    def sources(self) -> dict[str, Any]:
        """Say where the rows came from, for JSON."""
        return {
            "published": self.published_count,
            "kept": self.stored_count,
            "measured": self.measured_count,
            "directory": str(self.directory),
        }


def score_cells(
    cells: Iterable[Cell], workers: int, directory: Path | None, scheduler: str | None = None
) -> ScoredCells:
    """Read what is known of the cells and measure the rest.

    Raises
    ------
    StoreError
        Where published results or the working store cannot be read.
    UnknownNameError, StoreLockedError, ImportError, ClusterError, OtherCodeError, WorkerLostError
        As `benchmark.running.runner.run`.
    RunInterruptedError
        On Ctrl-C; what was measured is kept.
    """
    from benchmark.plan.parts import every_part  # noqa: PLC0415 - slow
    from benchmark.running.runner import run, stale  # noqa: PLC0415 - slow

    wanted, known = sorted(set(cells)), every_part()
    *shipped, work = every_store(directory)
    left, found = wanted, {}
    for store in shipped:
        missing = stale(left, store, parts=known)
        found.update(_rows(store, set(left) - set(missing)))
        left = missing
    missing = stale(left, work, parts=known)
    warnings: tuple[str, ...] = ()
    if missing:
        warnings = run(
            missing, work, workers, scheduler=scheduler, parts=known, others=shipped
        ).warnings
    found.update(_rows(work, set(left)))
    times = read_times(PUBLISHED)
    for cell, row in found.items():
        row.update(times.columns_of(cell.dataset, cell.extractor, cell.model))
    return ScoredCells(
        rows=[found[cell] for cell in wanted],
        published_count=len(wanted) - len(left),
        stored_count=len(left) - len(missing),
        measured_count=len(missing),
        directory=work.directory,
        warnings=warnings,
    )


def say_sources(published: int, kept: int, measured: int, directory: Path) -> None:
    """Say on stderr where scores come from, and where new ones are kept."""
    typer.echo(
        f"{published} published, {kept} measured before, {measured} measured now; new results are "
        f"kept in {directory}",
        err=True,
    )


def _rows(store: Store, cells: set[Cell]) -> dict[Cell, Row]:
    if not cells:
        return {}
    return {cell: row for row in store.rows(unit=None) if (cell := _cell(row)) in cells}


def _cell(row: Row) -> Cell:
    return Cell(row["dataset"], row["condition"], row["extractor"], row["model"], row["unit"])
