"""Where tasks are measured: in this process, in others, or on a Dask cluster. Same numbers."""

from __future__ import annotations

import os
import platform
import threading
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import MappingProxyType

from joblib import Parallel, delayed, parallel_config

from algorithms.extractors.frames.multi_spot.pattern_memory import shared_patterns
from benchmark.running.planned import FollowUp
from benchmark.running.task import Task, TaskResult, measure

#: Tasks a worker takes at once when there is too little to give each a whole dataset.
_BUNDLE = 4
#: Datasets for every worker from which on each is done by one worker.
_DATASETS_A_WORKER = 4


class DaskMissingError(ImportError):
    """A Dask scheduler was named and its client is not installed."""


def outcomes(
    tasks: Sequence[Task],
    workers: int,
    scheduler: str | None = None,
    follow_ups: Mapping[str, FollowUp] = MappingProxyType({}),
) -> Iterator[TaskResult]:
    """Measure tasks and give each result as soon as it is there, in any order.

    Parameters
    ----------
    tasks
        What to measure.
    workers
        Processes to use; with 1 everything happens in this one.
    scheduler
        Address of a Dask scheduler, e.g. ``tcp://127.0.0.1:8786``; `workers` is not read then.
    follow_ups
        By data set, what is measured besides where one bundle is all of the data set's tasks.

    Raises
    ------
    DaskMissingError
        When `scheduler` is given without the ``distributed`` package.
    """
    bundled = bundles(tasks, workers)
    following = [follow_ups.get(bundle[0].preset.name) for bundle in bundled]
    if scheduler is None and (workers == 1 or len(tasks) == 1):
        for bundle, follow_up in zip(bundled, following, strict=True):
            yield from _measured(bundle, follow_up)
        return
    with ExitStack() as stack:
        if scheduler is None:
            stack.enter_context(parallel_config("loky", n_jobs=workers, inner_max_num_threads=1))
        else:
            _connect(stack, scheduler)
        coordinator = (platform.node(), os.getpid())
        parallel = Parallel(return_as="generator_unordered", batch_size=1, pre_dispatch="2*n_jobs")
        measured = parallel(
            delayed(_measure_for)(coordinator, bundle, follow_up)
            for bundle, follow_up in zip(bundled, following, strict=True)
        )
        try:
            for results in measured:
                yield from results
        finally:
            with warnings.catch_warnings():
                # joblib's advice on what was in flight: the runner has said what is kept
                warnings.filterwarnings("ignore", ".*tasks which were still being processed.*")
                measured.close()


def bundles(tasks: Sequence[Task], workers: int = 1) -> list[list[Task]]:
    """Group tasks that follow each other and share samples or light, for one worker to do.

    Generating samples and their bound often costs more than the rest. With many datasets to do, a
    bundle is a dataset, whose conditions see the same light and whose units look it up in the same
    tables (see `benchmark.simulator.light.memory`); else at most four tasks of a dataset, unit and
    condition.
    """
    many = len({task.preset.name for task in tasks}) >= _DATASETS_A_WORKER * workers
    found: list[list[Task]] = []
    for task in tasks:
        last = found[-1] if found else []
        if (
            last
            and last[0].preset.name == task.preset.name
            and (many or (len(last) < _BUNDLE and _place(last[0]) == _place(task)))
        ):
            last.append(task)
        else:
            found.append([task])
    return found


def _place(task: Task) -> tuple[int, str]:
    return task.unit, task.condition


def _measured(bundle: Sequence[Task], follow_up: FollowUp | None) -> Iterator[TaskResult]:
    """Measure a bundle, then what follows from it."""
    first = []
    with shared_patterns():
        for task in bundle:
            first.append(measure(task))
            yield first[-1]
        yield from map(measure, follow_up.tasks(first) if follow_up else ())


def _measure_for(
    coordinator: tuple[str, int], bundle: Sequence[Task], follow_up: FollowUp | None
) -> list[TaskResult]:
    """Measure in a worker process, which ends when the coordinator does, even by a kill."""
    host, process = coordinator
    if (host, os.getppid()) == (platform.node(), process):
        _end_with(process)
    return list(_measured(bundle, follow_up))


@cache
def _end_with(parent: int) -> None:
    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True, name="end with the coordinator").start()


def _connect(stack: ExitStack, scheduler: str) -> None:
    if find_spec("distributed") is None:
        raise DaskMissingError(
            f"measuring on the Dask scheduler {scheduler} needs the package 'distributed'; "
            "install it beside this one (pip install distributed) or leave the scheduler out"
        )
    distributed = import_module("distributed")
    stack.enter_context(distributed.Client(scheduler))
    stack.enter_context(parallel_config("dask", n_jobs=-1))
