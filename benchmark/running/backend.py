"""Where tasks are measured: in this process, in others, or on a Dask cluster. Same numbers."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

from algorithms.extractors.frames.multi_spot.pattern_memory import shared_patterns
from benchmark.running.cluster import connect
from benchmark.running.durations import Durations, Took
from benchmark.running.planned import FollowUp
from benchmark.running.schedule import (
    Bundle,
    WaitingBundles,
    bundles,
    cut,
    longest_of,
    place_of,
    total_seconds,
)
from benchmark.running.task import Task, TaskResult, measure
from benchmark.running.workers import hands_of

_Timed = tuple[Task, TaskResult, Took]


@dataclass(frozen=True)
class Done:
    """What a worker hands back: results with their times, and what it leaves to others."""

    timed: list[_Timed]
    left: list[tuple[Task, ...]]


@dataclass(frozen=True)
class Work:
    """A bundle for a worker, and how much of what follows from it the worker goes on with.

    Attributes
    ----------
    bundle
        What to measure first.
    durations
        Known ones of its data set.
    most
        Seconds that one worker may take with a bundle.
    """

    bundle: Bundle
    durations: Durations
    most: float

    @property
    def tasks(self) -> tuple[Task, ...]:
        """What to measure first."""
        return self.bundle.tasks

    def __call__(self) -> Done:
        """Measure it all."""
        left: list[tuple[Task, ...]] = []
        return Done(list(self.measure(left)), left)

    def measure(self, left: list[tuple[Task, ...]]) -> Iterator[_Timed]:
        """Measure task by task; what is to be left to other workers is put into `left`."""
        results, places = [], set()

        def timed(task: Task) -> _Timed:
            place = place_of(task)
            started = time.process_time()
            result = measure(task)
            seconds = time.process_time() - started
            took = Took(len(task.models), int(place not in places), round(seconds, 3))
            places.add(place)
            return task, result, took

        with shared_patterns():
            for task in self.tasks:
                outcome = timed(task)
                results.append(outcome[1])
                yield outcome
            if self.bundle.follow_up is None:
                return
            further = self.bundle.follow_up.tasks(results)
            # what shares data or light with the first tasks is gone on with, up to the limit
            here, *others = cut([*self.tasks, *further], self.durations.seconds, self.most)
            left += others
            yield from map(timed, here[len(self.tasks) :])


class Hands(Protocol):
    """Workers that take bundles and give back what came of them."""

    def is_free(self) -> bool:
        """Say whether another bundle can be taken on."""

    def is_busy(self) -> bool:
        """Say whether something is still to come back."""

    def give(self, work: Work) -> None:
        """Have a bundle measured."""

    def take(self) -> Done:
        """Wait for the next bundle that is done, in any order."""


def outcomes(
    tasks: Sequence[Task],
    workers: int,
    scheduler: str | None = None,
    follow_ups: Mapping[str, FollowUp] = MappingProxyType({}),
    durations: Durations | None = None,
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
    durations
        How long tasks took before, by which they are shared out; takes in how long they took now.

    Raises
    ------
    DaskMissingError, ClusterError, OtherCodeError
        Where `scheduler` is given: as `benchmark.running.cluster`.
    WorkerLostError
        When worker processes were killed; of a cluster, one after another over the same tasks.
    """
    known = Durations() if durations is None else durations
    for task, result, took in _timed(tasks, workers, scheduler, follow_ups, known):
        known.add(task, took)
        yield result


def _timed(
    tasks: Sequence[Task],
    workers: int,
    scheduler: str | None,
    follow_ups: Mapping[str, FollowUp],
    durations: Durations,
) -> Iterator[_Timed]:
    if scheduler is not None:
        with connect(scheduler) as cluster:
            yield from shared_out(tasks, cluster, cluster.workers(), follow_ups, durations)
    elif workers == 1 or len(tasks) == 1:
        for bundle in bundles(tasks, durations, math.inf, follow_ups):
            yield from Work(bundle, durations, math.inf).measure([])
    else:
        with hands_of(workers) as hands:
            yield from shared_out(tasks, hands, workers, follow_ups, durations)


def shared_out(
    tasks: Sequence[Task],
    hands: Hands,
    workers: int,
    follow_ups: Mapping[str, FollowUp],
    durations: Durations,
) -> Iterator[_Timed]:
    """Hand bundles out, longest first, and what is left of them as it becomes known."""
    known = Durations(dict(durations.known))  # who gets results adds to the other
    most = longest_of(total_seconds(tasks, known, follow_ups), workers)
    waiting = WaitingBundles(bundles(tasks, known, most, follow_ups))

    def hand_out() -> None:
        while len(waiting) and hands.is_free():
            bundle = waiting.take()
            hands.give(Work(bundle, known.of(bundle.tasks[0].preset.name), most))

    hand_out()
    while hands.is_busy():
        done = hands.take()
        for left in done.left:
            waiting.add(Bundle(left, known.seconds(left)))
        hand_out()  # before results are kept: no worker waits for that
        yield from done.timed
