"""Where tasks are measured: in this process, in others, or on a Dask cluster. Same numbers."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from functools import partial
from types import MappingProxyType

from algorithms.extractors.frames.multi_spot.pattern_memory import shared_patterns
from benchmark.running.cluster import connect
from benchmark.running.durations import Took
from benchmark.running.planned import FollowUp
from benchmark.running.task import Task, TaskResult, measure
from benchmark.running.workers import as_completed

#: Tasks a worker takes at once when there is too little to give each a whole dataset.
_BUNDLE = 4
#: Datasets for every worker from which on each is done by one worker.
_DATASETS_A_WORKER = 4

_Timed = tuple[Task, TaskResult, Took]


def outcomes(
    tasks: Sequence[Task],
    workers: int,
    scheduler: str | None = None,
    follow_ups: Mapping[str, FollowUp] = MappingProxyType({}),
    took: Callable[[Task, Took], None] = lambda _task, _took: None,
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
    took
        Told of each task how long it took.

    Raises
    ------
    DaskMissingError, ClusterError, OtherCodeError
        Where `scheduler` is given: as `benchmark.running.cluster`.
    WorkerLostError
        When worker processes were killed; of a cluster, one after another over the same tasks.
    """
    for task, result, seconds in _time(tasks, workers, scheduler, follow_ups):
        took(task, seconds)
        yield result


def _time(
    tasks: Sequence[Task],
    workers: int,
    scheduler: str | None,
    follow_ups: Mapping[str, FollowUp],
) -> Iterator[_Timed]:
    if scheduler is not None:
        with connect(scheduler) as cluster:
            yield from cluster.outcomes(
                [
                    (bundle, partial(_all_measured, bundle, follow_ups.get(bundle[0].preset.name)))
                    for bundle in bundles(tasks, cluster.workers())
                ]
            )
        return
    bundled = bundles(tasks, workers)
    following = [follow_ups.get(bundle[0].preset.name) for bundle in bundled]
    if workers == 1 or len(tasks) == 1:
        for bundle, follow_up in zip(bundled, following, strict=True):
            yield from _measure(bundle, follow_up)
        return
    pairs = zip(bundled, following, strict=True)
    with closing(as_completed(_pair_measured, pairs, workers)) as measured:
        for results in measured:
            yield from results


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


def _measure(bundle: Sequence[Task], follow_up: FollowUp | None) -> Iterator[_Timed]:
    """Measure a bundle, then what follows from it."""
    first, places = [], set()

    def timed(task: Task) -> _Timed:
        place = task.preset.name, *_place(task)
        started = time.process_time()
        result = measure(task)
        seconds = time.process_time() - started
        took = Took(len(task.models), int(place not in places), round(seconds, 3))
        places.add(place)
        return task, result, took

    with shared_patterns():
        for task in bundle:
            outcome = timed(task)
            first.append(outcome[1])
            yield outcome
        yield from map(timed, follow_up.tasks(first) if follow_up else ())


def _pair_measured(pair: tuple[Sequence[Task], FollowUp | None]) -> list[_Timed]:
    return _all_measured(*pair)


def _all_measured(bundle: Sequence[Task], follow_up: FollowUp | None) -> list[_Timed]:
    return list(_measure(bundle, follow_up))
