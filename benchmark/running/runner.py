"""Measure cells into a store: in parallel, resumable, never twice what is already there.

A task is one (dataset, condition, unit, extractor); a worker takes those that share samples or
light. Only this process writes, and what a worker hands back is on disk before the next is awaited,
so a killed run loses what was in flight and nothing else. Numbers do not depend on the number of
workers.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from contextlib import closing, nullcontext
from dataclasses import dataclass
from pathlib import Path

from benchmark.contract import Cell
from benchmark.plan.parts import Parts, installed_parts
from benchmark.processes import end_if_requested
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.components import Components, current
from benchmark.results.record import Record, open_record
from benchmark.results.store import Store
from benchmark.running.kept_stages import KeptStages
from benchmark.running.planned import cells_of, numbers_of, samples_of, tasks_of
from benchmark.running.schedule import outcomes
from benchmark.running.stages import Task
from benchmark.running.task import TaskResult


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
    keep_stages: bool = True,
    others: Iterable[Store] = (),
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
    keep_stages
        Whether data, features and predictions are kept beside the store and taken from there.
        The numbers are the same.
    others
        Stores beside which stages are looked for, too.

    Raises
    ------
    UnknownNameError
        For a cell whose names are not installed.
    StoreLockedError
        When another runner writes to the store.
    DaskMissingError, ClusterError, OtherCodeError
        When a scheduler is given and ``distributed`` is not installed, the cluster cannot be
        measured on, or has other code.
    WorkerLostError
        When worker processes were killed; what was measured is kept and not measured again.
    RunInterruptedError
        On Ctrl-C; what was measured is kept and not measured again.
    """
    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
    started = time.perf_counter()
    parts = parts or installed_parts()
    wanted = known_cells(cells, parts)
    components = current(parts)
    with open_record(store) as record:
        missing = measure_missing(
            wanted,
            record,
            components,
            parts,
            workers=workers,
            progress=progress,
            scheduler=scheduler,
            kept=kept_beside(store, components, others) if keep_stages else None,
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
    kept: KeptStages | None = None,
) -> int:
    """Measure the cells that a record does not hold of these components; returns how many.

    Parameters and errors as `run`; `kept` is where stages are kept, nowhere for None.
    """
    missing = [cell for cell in sorted(wanted) if not record.is_scored(cell, components)]
    # the standard units first: what they tell of the directions that can be observed saves every
    # other unit a bound
    stages = [[c for c in missing if c.unit == 0], [c for c in missing if c.unit != 0]]
    if not missing:
        return 0
    done, total = 0, len(missing)
    with terminal_progress() if progress is None else nullcontext(progress) as report:
        report(done, total, "")
        try:
            for stage in filter(None, stages):
                tasks = tasks_of(stage, parts, record.pins)
                with closing(outcomes(tasks, workers, scheduler, kept)) as results:
                    for result in results:
                        end_if_requested()
                        _keep(result, record, components)
                        done += len(result.outcomes)
                        report(done, total, _named(result.task))
        except KeyboardInterrupt as error:
            raise RunInterruptedError(
                f"interrupted with {done} of {total} cells measured; they are kept in "
                f"{record.journal} and not measured again by the next run"
            ) from error
    return done


def _named(task: Task) -> str:
    return f"{task.preset.name} {task.condition} {task.extractor.about.name}"


def _keep(result: TaskResult, record: Record, components: Components) -> None:
    """Take a finished task into the record, on disk."""
    samples = samples_of(result)
    record.keep(
        components,
        pins=[pin for pin in result.pins if not record.is_pinned(pin.place, components)],
        scores=dict(zip(cells_of(result), numbers_of(result), strict=True)),
        errors=samples.cells,
        directions=samples.directions,
    )


def kept_beside(
    store: Store,
    components: Components,
    others: Iterable[Store] = (),
) -> KeptStages | None:
    """Return the stages kept beside stores; None where nothing is to be kept."""
    looked_at = [other.work_directory for other in others]
    return KeptStages.beside(store.work_directory, components, looked_at)


def failures(cells: Iterable[Cell], record: Record) -> tuple[tuple[Cell, str], ...]:
    """List the cells that failed, with the reason."""
    return tuple(
        (cell, record.scores[cell]["reason"])
        for cell in cells
        if record.scores[cell]["status"] == "failed"
    )


def stale(cells: Iterable[Cell], store: Store, *, parts: Parts | None = None) -> list[Cell]:
    """List the cells that the store does not hold as code and data now are; renders nothing.

    UnknownNameError for a cell whose names are not installed.
    """
    known = parts or installed_parts()
    wanted = known_cells(cells, known)
    if not wanted:
        return []
    # digests of what nobody asks about would be most of the time
    record, components = Record(store), current(known.only(wanted))
    return [cell for cell in wanted if not record.is_scored(cell, components)]


def known_cells(cells: Iterable[Cell], parts: Parts) -> list[Cell]:
    """Cells once each, in order; UnknownNameError for one whose names are not installed."""
    wanted = sorted(set(cells))
    for cell in wanted:
        parts.preset(cell.dataset)
        parts.extractor(cell.extractor)
        parts.model(cell.model)
    return wanted
