"""Which tasks a worker is given together: those that share data or light; the most work first."""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator, Hashable, Sequence
from contextlib import closing
from copy import deepcopy
from dataclasses import replace
from functools import partial

from algorithms.extractors.frames.multi_spot.pattern_memory import shared_patterns
from benchmark.processes import release_free_memory
from benchmark.results.digests import method_modules, modules_of
from benchmark.results.modules import STAGES, modules_digest
from benchmark.running.fitting import data_condition
from benchmark.running.kept_stages import KeptStages
from benchmark.running.stages import Task
from benchmark.running.task import TaskResult, measure
from benchmark.running.workers import as_completed

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
