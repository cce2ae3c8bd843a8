"""Measure cells into a store: in parallel, resumable, never twice what is already there.

A task is one (dataset, condition, unit, extractor); a worker takes those that share samples or
light. Only this process writes, and what a worker hands back is on disk before the next is awaited,
so a killed run loses what was in flight and nothing else. Numbers do not depend on the number of
workers.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Generator, Hashable, Iterable, Sequence
from contextlib import closing, nullcontext
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from algorithms.extractors.frames.multi_spot.pattern_memory import shared_patterns
from benchmark.contract import Cell
from benchmark.plan.parts import Parts, installed_parts
from benchmark.processes import end_if_requested, release_free_memory
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.components import Components, current
from benchmark.results.digests import method_modules, modules_of
from benchmark.results.modules import STAGES, modules_digest
from benchmark.results.record import Record, open_record
from benchmark.results.samples import GREATEST_UNIT
from benchmark.results.store import Store
from benchmark.running.fitting import data_condition
from benchmark.running.kept_stages import KeptStages
from benchmark.running.planned import cells_of, numbers_of, samples_of, tasks_of
from benchmark.running.stages import Task
from benchmark.running.task import TaskResult, measure
from benchmark.running.workers import as_completed


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

    Cells are as planned by `benchmark.plan.combinations.cells`, `parts` what is installed by
    default. `progress` is called as ``progress(done, total, what)`` in cells; by default a bar on
    standard error when that is a terminal. `scheduler` is the address of a Dask scheduler to
    measure on instead of processes of this machine. Data, features and predictions are kept beside
    the store, and looked for there and beside `others`, unless `keep_stages` is False; the numbers
    are the same.

    Raises
    ------
    UnknownNameError, ValueError
        As `known_cells`; ValueError for less than one worker, too.
    StoreLockedError
        When another runner writes to the store.
    ImportError, ClusterError, OtherCodeError
        When the cluster cannot be measured on, or has other code.
    WorkerLostError, RunInterruptedError
        When workers were killed, and on Ctrl-C; what was measured is kept and not measured again.
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

    Raises
    ------
    UnknownNameError, ValueError
        As `known_cells`.
    """
    known = parts or installed_parts()
    wanted = known_cells(cells, known)
    if not wanted:
        return []
    # digests of what nobody asks about would be most of the time
    record, components = Record(store), current(known.only(wanted))
    return [cell for cell in wanted if not record.is_scored(cell, components)]


def known_cells(cells: Iterable[Cell], parts: Parts) -> list[Cell]:
    """Return cells once each, in order.

    Raises
    ------
    UnknownNameError
        For a cell whose names are not installed.
    ValueError
        For a unit below 0 or above `GREATEST_UNIT`, the last whose errors can be kept.
    """
    wanted = sorted(set(cells))
    for cell in wanted:
        if not 0 <= cell.unit <= GREATEST_UNIT:
            raise ValueError(f"{cell}: expected a unit from 0 to {GREATEST_UNIT}")
        parts.preset(cell.dataset)
        parts.extractor(cell.extractor)
        parts.model(cell.model)
    return wanted


#: What tasks share by which they stay together, and how many pieces a worker there then must be:
#: the light of a unit; the data of one condition; nothing.
_SHARED: tuple[tuple[Callable[[Task], Hashable], int], ...] = (
    (lambda task: (task.preset.name, task.unit), 4),
    (lambda task: (task.preset.name, task.unit, data_condition(task.preset, task.condition)), 1),
    (id, 0),
)
#: How many workers a cluster is taken to have.
_OF_CLUSTER = 16
#: What a worker keeps between tasks, and how many threads it computes in, are the process's own.
_ONE_AT_A_TIME = threading.Lock()


class OtherCodeError(RuntimeError):
    """A worker of a cluster has other code than the process that keeps the results."""


def outcomes(
    tasks: Sequence[Task], workers: int, scheduler: str | None, kept: KeptStages | None
) -> Generator[TaskResult, None, None]:
    """Measure tasks and yield the results of each piece as soon as it is done.

    Parameters and errors as `benchmark.running.workers.as_completed`; `kept` is where stages are
    kept, nowhere for None or for a worker that does not see the directory.
    """
    cut = pieces(tasks, workers if scheduler is None else _OF_CLUSTER)
    named = [(piece, None if scheduler is None else code_of(piece)) for piece in cut]
    work = partial(_measure, kept)
    with shared_patterns(), closing(as_completed(work, named, workers, scheduler)) as done:
        for results in done:
            yield from results


def pieces(tasks: Sequence[Task], workers: int) -> list[tuple[Task, ...]]:
    """Cut tasks into pieces as large as keeps all workers busy, those of most pipelines first.

    One worker takes the tasks one by one, in their order: what they share, it keeps.
    """
    if workers == 1:
        return [(task,) for task in tasks]
    for shared, least in _SHARED:
        found: dict[Hashable, list[Task]] = {}
        for task in tasks:
            found.setdefault(shared(task), []).append(task)
        if len(found) >= least * workers:
            break
    return sorted(map(tuple, found.values()), key=lambda cut: -sum(len(t.models) for t in cut))


def _measure(kept: KeptStages | None, piece: tuple[Sequence[Task], str | None]) -> list[TaskResult]:
    tasks, code = piece
    with _ONE_AT_A_TIME, shared_patterns():
        if code is not None and code != code_of(tasks):
            raise OtherCodeError(
                f"a worker has other code for {tasks[0].preset.name} than this process: its "
                "numbers would be taken for those of the code here; bring both to the same version"
            )
        if kept is not None and not kept.files.directory.parent.is_dir():
            kept = None  # the worker is on another machine
        # what a preset computes on its way, 50 MB of some, is not to go from process to process
        own = deepcopy(tasks[0].preset)
        done = [replace(measure(replace(one, preset=own), kept), task=one) for one in tasks]
    release_free_memory()
    return done


def code_of(tasks: Sequence[Task]) -> str:
    """Digest of the code that measures these tasks: of all stages, their data and methods."""
    found = {"benchmark.running.task", *STAGES.values(), *modules_of(tasks[0].preset)}
    for method in {method for task in tasks for method in (task.extractor, *task.models)}:
        found.update(method_modules(method))
    return modules_digest(*sorted(found))
