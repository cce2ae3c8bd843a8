"""Where tasks are measured: in this process, in others, or on a Dask cluster. Same numbers."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from itertools import chain
from types import MappingProxyType
from typing import Protocol

from algorithms.extractors.frames.multi_spot.pattern_memory import shared_patterns
from benchmark.contract import Cell
from benchmark.running.cluster import connect
from benchmark.running.durations import Durations, Took
from benchmark.running.kept_stages import DATA, KeptStages
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
    left: list[Bundle]


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
    kept
        Where stages are kept; nowhere for None.
    """

    bundle: Bundle
    durations: Durations
    most: float
    kept: KeptStages | None = None

    @property
    def tasks(self) -> tuple[Task, ...]:
        """What to measure first."""
        return self.bundle.tasks

    def __call__(self) -> Done:
        """Measure it all."""
        left: list[Bundle] = []
        return Done(list(self.measure(left)), left)

    def measure(self, left: list[Bundle]) -> Iterator[_Timed]:
        """Measure task by task; what is to be left to other workers is put into `left`."""
        results, places = [], set()
        # what a preset computes on its way, 50 MB of some, is not to go from process to process
        own = deepcopy(self.tasks[0].preset)
        durations = Durations(dict(self.durations.known))

        def timed(task: Task) -> _Timed:
            place = place_of(task)
            made = place not in places and not self._data_kept(task)
            started = time.process_time()
            result = replace(measure(replace(task, preset=own), self.kept), task=task)
            seconds = time.process_time() - started
            took = Took(len(task.models), int(made), round(seconds, 3))
            places.add(place)
            durations.learn(task, took)
            return task, result, took

        with shared_patterns():
            for task in self.tasks:
                outcome = timed(task)
                results.append(outcome[1])
                yield outcome
            left += self.bundle.then
            if self.bundle.follow_up is None or self.bundle.then:
                return
            further = self.bundle.follow_up.tasks(results)
            # what shares data or light with the first tasks is gone on with, up to the limit
            here, *others = cut([*self.tasks, *further], durations.seconds, self.most)
            rest = list(chain.from_iterable(others))
            left += bundles(rest, durations, self.most, apart=self.kept is not None)
            yield from map(timed, here[len(self.tasks) :])

    def _data_kept(self, task: Task) -> bool:
        dataset, unit, condition = place_of(task)
        return self.kept is not None and self.kept.has(DATA, Cell(dataset, condition, "", "", unit))


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
    *,
    kept: KeptStages | None = None,
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
        By data set, what is measured besides once all of the data set's tasks are.
    durations
        How long tasks took before, by which they are shared out; takes in how long they took now.
    kept
        Where stages are kept; nowhere for None, and on a cluster whose workers do not see it.

    Raises
    ------
    DaskMissingError, ClusterError, OtherCodeError
        Where `scheduler` is given: as `benchmark.running.cluster`.
    WorkerLostError
        When worker processes were killed; of a cluster, one after another over the same tasks.
    """
    known = Durations() if durations is None else durations
    for task, result, took in _timed(tasks, workers, scheduler, follow_ups, known, kept=kept):
        if result.reused:
            known.learn(task, took)
        else:
            known.add(task, took)
        yield result


def _timed(
    tasks: Sequence[Task],
    workers: int,
    scheduler: str | None,
    follow_ups: Mapping[str, FollowUp],
    durations: Durations,
    *,
    kept: KeptStages | None,
) -> Iterator[_Timed]:
    if scheduler is not None:
        with connect(scheduler) as cluster:
            if kept is not None and not cluster.sees(kept.files.directory):
                kept = None
            yield from shared_out(
                tasks, cluster, cluster.workers(), follow_ups, durations, kept=kept
            )
    elif workers == 1 or len(tasks) == 1:
        for bundle in bundles(tasks, durations, math.inf, follow_ups):
            yield from Work(bundle, durations, math.inf, kept).measure([])
    else:
        with hands_of(workers) as hands:
            yield from shared_out(tasks, hands, workers, follow_ups, durations, kept=kept)


def shared_out(
    tasks: Sequence[Task],
    hands: Hands,
    workers: int,
    follow_ups: Mapping[str, FollowUp],
    durations: Durations,
    *,
    kept: KeptStages | None = None,
) -> Iterator[_Timed]:
    """Hand bundles out, longest first, and what is left of them as it becomes known."""
    known = Durations(dict(durations.known))  # who gets results adds to the other
    most = longest_of(total_seconds(tasks, known, follow_ups), workers)
    apart = kept is not None
    waiting = WaitingBundles(bundles(tasks, known, most, follow_ups, apart=apart))
    #: Of data sets whose first tasks are in several bundles, results until something follows.
    first: dict[str, list[TaskResult]] = {}

    def hand_out() -> None:
        while len(waiting) and hands.is_free():
            bundle = waiting.take()
            if bundle.then and bundle.follow_up is not None:
                first[bundle.dataset] = []
            hands.give(Work(bundle, known.of(bundle.dataset), most, kept))

    def followers(done: Done) -> Iterator[Bundle]:
        for name in first.keys() & {task.preset.name for task, *_ in done.timed}:
            first[name] += (one for task, one, _ in done.timed if task.preset.name == name)
            if further := follow_ups[name].tasks(first[name]):
                del first[name]
                yield from bundles(further, known, most, apart=apart)

    hand_out()
    while hands.is_busy():
        done = hands.take()
        for task, _, took in done.timed:
            known.learn(task, took)
        for bundle in (*done.left, *followers(done)):
            waiting.add(bundle)
        hand_out()  # before results are kept: no worker waits for that
        yield from done.timed
