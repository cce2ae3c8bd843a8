"""Measure cells into a store: in parallel, resumable, never twice what is already there.

A task is one (dataset, condition, unit, extractor); a worker takes those that share samples or
light. Only this process writes, and what a worker hands back is on disk before the next is awaited,
so a killed run loses what was in flight and nothing else. Numbers do not depend on the number of
workers.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

from benchmark.contract import Cell
from benchmark.plan.parts import Parts, installed_parts
from benchmark.processes import end_if_requested
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.components import Components, current
from benchmark.results.record import Record, open_record
from benchmark.results.store import Store
from benchmark.running.backend import outcomes
from benchmark.running.durations import Durations, ExtractionTask
from benchmark.running.kept_stages import KeptStages
from benchmark.running.planned import FollowUp, cells_of, numbers_of, samples_of, tasks_of
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
        Called as ``progress(done, total, what, share)`` in cells, with the share of the time
        that all takes as far as that is known, else None; by default a bar on standard error when
        that is a terminal.
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
    follow_ups: Mapping[str, FollowUp] | None = None,
    kept: KeptStages | None = None,
) -> int:
    """Measure the cells that a record does not hold of these components; returns how many.

    With what followed from them. Parameters and errors as `run`.

    Parameters
    ----------
    follow_ups
        By data set, what a worker that measured all its first cells goes on with at once.
    kept
        Where stages are kept; nowhere for None.
    """
    missing = [cell for cell in sorted(wanted) if not record.is_scored(cell, components)]
    # the standard units first: what they tell of the directions that can be observed saves every
    # other unit a bound
    stages = [[c for c in missing if c.unit == 0], [c for c in missing if c.unit != 0]]
    done = 0
    if missing:
        with terminal_progress() if progress is None else nullcontext(progress) as report:
            expected = Durations.read([record.store]).seconds_by_task(missing)
            counted = _Count(report, len(missing), sum(expected.values()))
            for stage in filter(None, stages):
                tasks = tasks_of(stage, parts, record.pins)
                durations = Durations.read([record.store])
                results = outcomes(
                    tasks, workers, scheduler, follow_ups or {}, durations, kept=kept
                )
                try:
                    _keep_all(results, record, components, counted, expected)
                finally:
                    durations.keep(record.store)
            done = counted.done
    return done


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

    Raises
    ------
    UnknownNameError
        For a cell whose names are not installed.
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


@dataclass
class _Count:
    """How far measuring has come, for the progress display."""

    report: ProgressCallback
    total: int
    expected_s: float = 0.0
    done: int = 0
    done_s: float = 0.0

    def __post_init__(self) -> None:
        self.report(0, self.total, "")

    def add(self, cells: int, what: str, seconds: float) -> None:
        self.done += cells
        self.done_s += seconds
        self.total = max(self.total, self.done)  # what followed was not counted before
        share = min(self.done_s / self.expected_s, 1.0) if self.expected_s else None
        self.report(self.done, self.total, what, share)


def _keep_all(
    results: Iterable[TaskResult],
    record: Record,
    components: Components,
    counted: _Count,
    expected: Mapping[ExtractionTask, float],
) -> None:
    """Take every finished task into the record, which is on disk before the next is awaited."""
    try:
        for result in results:
            end_if_requested()
            task = result.task
            scores = dict(zip(cells_of(result), numbers_of(result), strict=True))
            new = [pin for pin in result.pins if not record.is_pinned(pin.place, components)]
            samples = samples_of(result)
            record.keep(
                components,
                pins=new,
                scores=scores,
                errors=samples.cells,
                directions=samples.directions,
            )
            what = f"{task.preset.name} {task.condition} {task.extractor.about.name}"
            seconds = sum(expected.get(of, 0.0) for of in {ExtractionTask.of(c) for c in scores})
            counted.add(len(scores), what, seconds)
    except KeyboardInterrupt as error:
        raise RunInterruptedError(
            f"interrupted with {counted.done} of {counted.total} cells measured; they are kept in "
            f"{record.journal} and not measured again by the next run"
        ) from error
