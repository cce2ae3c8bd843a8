"""Measure cells into a store: in parallel, resumable, never twice what is already there.

A task is one (dataset, condition, unit, extractor); a worker takes a few that share samples. Only
this process writes, and what a worker hands back is on disk before the next is awaited, so a
killed run loses what was in flight and nothing else. Numbers do not depend on the number of
workers.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from contextlib import nullcontext
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from benchmark.contract import Cell
from benchmark.metrics.score import METRICS
from benchmark.plan.parts import Parts, installed
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.components import Components, current
from benchmark.results.record import Record, opened
from benchmark.results.store import Store
from benchmark.results.tables import Row
from benchmark.running.backend import outcomes
from benchmark.running.task import Outcome, Task, TaskResult


@dataclass(frozen=True)
class Summary:
    """What a run did."""

    store: Path
    planned: int
    already_stored: int
    computed: int
    failed: tuple[tuple[Cell, str], ...]
    warnings: tuple[str, ...]
    seconds: float


class RunInterruptedError(KeyboardInterrupt):
    """Ctrl-C during a run; the message says what is kept."""


def run(
    cells: Iterable[Cell],
    store: Store,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    scheduler: str | None = None,
    parts: Parts | None = None,
) -> Summary:
    """Measure the cells that the store does not hold yet; what else it holds stays.

    Scores of components that have changed and are measured here are dropped: those of other cells
    too, which their code no longer vouches for. Data that changed are taken as they are, whatever
    their version: a dataset in the making changes often. What is published is guarded by
    `benchmark.leaderboard.update`.

    Parameters
    ----------
    cells
        What to measure, as planned by `benchmark.plan.combinations.cells`.
    store
        Where results go.
    workers
        Number of processes; 1 measures in this one.
    progress
        Called as ``progress(done, total, what)`` in cells; by default a bar on standard error
        when that is a terminal.
    scheduler
        Address of a Dask scheduler to measure on instead.
    parts
        Datasets and implementations; what is installed by default.

    Raises
    ------
    UnknownNameError
        For a cell whose names are not installed.
    StoreLockedError
        When another runner writes to the store.
    DaskMissingError
        When a scheduler is given and ``distributed`` is not installed.
    RunInterruptedError
        On Ctrl-C; what was measured is kept and not measured again.
    """
    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
    started = time.perf_counter()
    parts = parts or installed()
    wanted = _known(cells, parts)
    components = current(parts)
    with opened(store) as record:
        missing = measure_missing(
            wanted,
            record,
            components,
            parts,
            workers=workers,
            progress=progress,
            scheduler=scheduler,
        )
        record.write(components.only(wanted))
    return Summary(
        store=store.directory,
        planned=len(wanted),
        already_stored=len(wanted) - missing,
        computed=missing,
        failed=failures(wanted, record),
        warnings=(),
        seconds=time.perf_counter() - started,
    )


def measure_missing(
    wanted: Iterable[Cell],
    record: Record,
    components: Components,
    parts: Parts,
    *,
    workers: int,
    progress: ProgressCallback | None = None,
    scheduler: str | None = None,
) -> int:
    """Measure the cells that a record does not hold of these components; returns how many.

    Parameters and errors as `run`.
    """
    missing = [cell for cell in sorted(wanted) if not record.is_scored(cell, components)]
    # the standard units first: what they tell of the directions that can be observed saves every
    # other unit a bound
    stages = [[c for c in missing if c.unit == 0], [c for c in missing if c.unit != 0]]
    if missing:
        with terminal_progress() if progress is None else nullcontext(progress) as report:
            counted = _Count(report, len(missing))
            for stage in filter(None, stages):
                results = outcomes(_tasks(stage, record, parts), workers, scheduler)
                _keep_all(results, record, components, counted)
    return len(missing)


def failures(cells: Iterable[Cell], record: Record) -> tuple[tuple[Cell, str], ...]:
    """List the cells that failed, with the reason."""
    return tuple(
        (cell, record.scores[cell]["reason"])
        for cell in cells
        if record.scores[cell]["status"] == "failed"
    )


def stale(cells: Iterable[Cell], store: Store, *, parts: Parts | None = None) -> list[Cell]:
    """List the cells that the store does not hold as code and data now are; renders nothing.

    Raises
    ------
    UnknownNameError
        For a cell whose names are not installed.
    """
    known = parts or installed()
    wanted = _known(cells, known)
    record, components = Record(store), current(known)
    return [cell for cell in wanted if not record.is_scored(cell, components)]


def _known(cells: Iterable[Cell], parts: Parts) -> list[Cell]:
    """Cells once each, in order; UnknownNameError for one whose names are not installed."""
    wanted = sorted(set(cells))
    for cell in wanted:
        parts.preset(cell.dataset)
        parts.extractor(cell.extractor)
        parts.model(cell.model)
    return wanted


def _tasks(cells: list[Cell], record: Record, parts: Parts) -> list[Task]:
    """Cells in tasks, those of one dataset, unit and condition in a row: they share samples."""
    return [
        Task(
            parts.preset(dataset),
            condition,
            parts.extractor(extractor),
            tuple(parts.model(cell.model) for cell in group),
            unit,
            _all_observable(record, dataset, condition),
        )
        for (dataset, unit, condition, extractor), group in groupby(
            sorted(cells, key=_order), key=lambda cell: _order(cell)[:4]
        )
    ]


def _order(cell: Cell) -> tuple[str, int, str, str, str]:
    return cell.dataset, cell.unit, cell.condition, cell.extractor, cell.model


def _all_observable(record: Record, dataset: str, condition: str) -> bool:
    pin = record.pins.get((dataset, condition, "test"))
    return pin is not None and pin.observable == pin.n


@dataclass
class _Count:
    """How far measuring has come, for who is told."""

    report: ProgressCallback
    total: int
    done: int = 0

    def __post_init__(self) -> None:
        self.report(0, self.total, "")

    def add(self, cells: int, what: str) -> None:
        self.done += cells
        self.report(self.done, self.total, what)


def _keep_all(
    results: Iterable[TaskResult], record: Record, components: Components, counted: _Count
) -> None:
    """Take every finished task into the record, which is on disk before the next is awaited."""
    try:
        for result in results:
            task = result.task
            scores = {_cell(task, outcome): _numbers(outcome) for outcome in result.outcomes}
            new = [pin for pin in result.pins if not record.is_pinned(pin.place, components)]
            record.keep(components, pins=new, scores=scores)
            what = f"{task.preset.name} {task.condition} {task.extractor.about.name}"
            counted.add(len(scores), what)
    except KeyboardInterrupt as error:
        raise RunInterruptedError(
            f"interrupted with {counted.done} of {counted.total} cells measured; they are kept in "
            f"{record.journal} and not measured again by the next run"
        ) from error


def _cell(task: Task, outcome: Outcome) -> Cell:
    return Cell(
        task.preset.name, task.condition, task.extractor.about.name, outcome.model, task.unit
    )


def _numbers(outcome: Outcome) -> Row:
    """Make the stored numbers of an outcome: depends on code and data only."""
    status = "ok" if outcome.score else "refused" if outcome.refused else "failed"
    metrics = outcome.score.row() if outcome.score else dict.fromkeys(METRICS)
    return {"status": status, **metrics, "reason": outcome.reason}
