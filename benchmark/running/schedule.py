"""Which tasks go to a worker together, and in which order: longest first, data made once.

Making data often costs more than all else: tasks that share them (one data set, condition and
unit) stay together. Where they would keep a worker for longer than the others, and stages are kept,
one worker makes the data and some features; what is left goes on from the data as they are kept,
each extractor in one place. Conditions of a unit see the same light and units look it up in the
same tables: these stay together, too, unless that takes too long.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import count
from types import MappingProxyType

from benchmark.running.durations import Durations
from benchmark.running.planned import FollowUp
from benchmark.running.task import Task, data_condition

#: Parts of a worker's share of all time that a bundle may take: the last ones end nearly together.
_PARTS = 4

Seconds = Callable[[Sequence[Task]], float]
_Place = tuple[str, int, str]


@dataclass(frozen=True)
class Bundle:
    """Tasks of one data set for one worker.

    Attributes
    ----------
    tasks
        In the order in which they are measured.
    seconds
        How long they take and all that follows from them, as far as it is known.
    follow_up
        What is measured besides once they are.
    then
        Other tasks of the same data, which go on from them as they are kept.
    """

    tasks: tuple[Task, ...]
    seconds: float
    follow_up: FollowUp | None = None
    then: tuple[Bundle, ...] = ()

    @property
    def dataset(self) -> str:
        """Name of the data set."""
        return self.tasks[0].preset.name


class WaitingBundles:
    """Bundles that no worker has yet; the longest is taken first, of equal ones the earliest."""

    def __init__(self, bundles: Sequence[Bundle]) -> None:
        self._order = count()
        self._heap: list[tuple[float, int, Bundle]] = []
        for bundle in bundles:
            self.add(bundle)

    def __len__(self) -> int:
        return len(self._heap)

    def add(self, bundle: Bundle) -> None:
        """Put in another one."""
        heappush(self._heap, (-bundle.seconds, next(self._order), bundle))

    def take(self) -> Bundle:
        """Take out the longest; IndexError where none is left."""
        return heappop(self._heap)[2]


def place_of(task: Task) -> _Place:
    """Return what names the data of a task: data set, unit and condition."""
    return task.preset.name, task.unit, data_condition(task.preset, task.condition)


def cut(tasks: Sequence[Task], seconds: Seconds, most: float) -> list[tuple[Task, ...]]:
    """Cut tasks into bundles of one data set, each of whole data and at most so long if it can be.

    Parameters
    ----------
    tasks
        In the order of their bundles.
    seconds
        Says how long tasks take that share data.
    most
        Seconds that a bundle may take; one whose data alone take longer does.
    """
    shared: dict[_Place, list[Task]] = {}
    for task in tasks:
        shared.setdefault(place_of(task), []).append(task)
    found: list[list[Task]] = []
    room = 0.0
    for place, together in shared.items():
        takes = seconds(together) if most < math.inf else 0.0
        if found and found[-1][0].preset.name == place[0] and takes <= room:
            found[-1] += together
        else:
            found.append([*together])
            room = most
        room -= takes
    return [tuple(bundle) for bundle in found]


def pieces(tasks: Sequence[Task], seconds: Seconds, most: float) -> list[tuple[Task, ...]]:
    """Cut tasks that share data into pieces of whole extractors, at most so long if they can be.

    Parameters as `cut`.
    """
    shared: dict[str, list[Task]] = {}
    for task in tasks:
        shared.setdefault(task.extractor.about.name, []).append(task)
    found: list[list[Task]] = []
    for together in shared.values():
        if found and seconds([*found[-1], *together]) <= most:
            found[-1] += together
        else:
            found.append(together)
    return [tuple(piece) for piece in found]


def longest_of(total: float, workers: int) -> float:
    """Return how many seconds a bundle may take, where all workers together take `total`."""
    return math.inf if workers == 1 else total / (_PARTS * workers)


def bundles(
    tasks: Sequence[Task],
    durations: Durations,
    most: float,
    follow_ups: Mapping[str, FollowUp] = MappingProxyType({}),
    *,
    apart: bool = False,
) -> list[Bundle]:
    """Cut tasks, as `cut` does, and say what each bundle takes with what follows from it.

    Parameters
    ----------
    follow_ups
        By data set, what is measured besides once all of the data set's tasks are.
    apart
        Whether tasks that share data may be told apart: data are kept.
    """
    found = []
    for bundle in cut(tasks, durations.seconds, most):
        follow_up = follow_ups.get(bundle[0].preset.name)
        after = 0.0 if follow_up is None else durations.seconds_of_rest(bundle)
        one = apart and len(set(map(place_of, bundle))) == 1
        first, *rest = pieces(bundle, durations.seconds, most) if one else [bundle]
        then = tuple(Bundle(piece, durations.seconds(piece) + after) for piece in rest)
        found.append(Bundle(first, durations.seconds(bundle) + after, follow_up, then))
    return found


def total_seconds(
    tasks: Sequence[Task], durations: Durations, follow_ups: Mapping[str, FollowUp]
) -> float:
    """Return how long tasks take and what follows from them, as far as it is known."""
    return sum(one.seconds for one in bundles(tasks, durations, math.inf, follow_ups))
