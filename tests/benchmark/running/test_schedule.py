"""The schedule, simulated: data made once, and nearly nobody idle, with 2 to 64 workers.

`measured_durations.csv` holds the processor time of every data set's conditions and units, as
measured for the published record; `units` is "standard" for the standard unit, else how many other
units take so long each.
"""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Sequence
from heapq import heappop, heappush
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fake_atlas
import pytest

from benchmark.contract import ON_BENCH
from benchmark.running import backend
from benchmark.running.backend import Done, Work, shared_out
from benchmark.running.durations import Durations, Took
from benchmark.running.schedule import Bundle, WaitingBundles, cut, place_of
from benchmark.running.task import Task

MEASURED = Path(__file__).parent / "measured_durations.csv"


def task(dataset: str, condition: str, unit: int = 0, first: str = "quiet") -> Task:
    preset = fake_atlas.Diodes(name=dataset, conditions=(first,))
    return Task(preset, condition, fake_atlas.Currents, (), unit)


@pytest.fixture(scope="module")
def seconds() -> dict[Task, float]:
    """Every task of the record with its time: a task stands for a condition and unit."""
    found = {}
    with MEASURED.open() as file:
        for row in csv.DictReader(file):
            numbers = [0] if row["units"] == "standard" else range(1, 1 + int(row["units"]))
            for unit in numbers:
                one = task(row["dataset"], row["condition"], unit, "nominal")
                found[one] = float(row["seconds"])
    return found


class Workers:
    """Workers of a clock that goes from one end of a bundle to the next."""

    def __init__(self, workers: int, seconds: dict[Task, float]) -> None:
        self.idle = workers
        self.now = 0.0
        self.made: Counter[Any] = Counter()
        self._seconds = seconds
        self._under_way: list[tuple[float, int, Done]] = []
        self._given = 0

    def is_free(self) -> bool:
        return self.idle > 0

    def is_busy(self) -> bool:
        return bool(self._under_way)

    def give(self, work: Work) -> None:
        done = work()
        self.made.update({place_of(task) for task, *_ in done.timed})
        self._given += 1
        self.idle -= 1
        takes = sum(self._seconds[task] for task, *_ in done.timed)
        heappush(self._under_way, (self.now + takes, self._given, done))

    def take(self) -> Done:
        self.now, _, done = heappop(self._under_way)
        self.idle += 1
        return done


def run(seconds: dict[Task, float], durations: Durations, workers: int) -> Workers:
    """Simulate measuring all from nothing: what follows of a data set is known after its first."""
    first = [task for task in seconds if task.condition == "nominal" and task.unit == 0]
    follow_ups: Any = {
        one.preset.name: SimpleNamespace(
            tasks=lambda _, one=one: [
                task for task in seconds if task.preset.name == one.preset.name and task is not one
            ]
        )
        for one in first
    }
    hands = Workers(workers, seconds)
    list(shared_out(first, hands, workers, follow_ups, durations))
    return hands


@pytest.fixture
def known(seconds: dict[Task, float], monkeypatch: pytest.MonkeyPatch) -> Durations:
    """What an earlier run has recorded of times; nothing is measured really."""
    monkeypatch.setattr(backend, "measure", lambda task: task)
    durations = Durations()
    for one, takes in seconds.items():
        durations.add(one, Took(0, 1, takes))
    return durations


def longest_chain(seconds: dict[Task, float]) -> float:
    """Return the longest time of a data set's first condition and one more that follows it."""
    places: dict[Any, float] = {}
    for one, takes in seconds.items():
        places[place_of(one)] = places.get(place_of(one), 0.0) + takes
    return max(
        takes + max(more for other, more in places.items() if other[0] == name and other != place)
        for place, takes in places.items()
        if (name := place[0]) and place[1:] == (0, "nominal")
    )


@pytest.mark.parametrize("workers", [2, 4, 8, 10, 11, 16, 32, 64])
def test_speed_up_is_near_ideal_and_data_are_made_once(
    seconds: dict[Task, float], known: Durations, workers: int
) -> None:
    hands = run(seconds, known, workers)
    assert set(hands.made.values()) == {1}
    assert len(hands.made) == 1070 - 10 * 40, "drawn benches are of the first condition's data"
    ideal = max(sum(seconds.values()) / workers, longest_chain(seconds))
    assert ideal / hands.now >= 0.9, f"{workers} workers: {hands.now:.1f} s; ideal {ideal:.1f} s"


@pytest.mark.parametrize("workers", [2, 16, 64])
@pytest.mark.parametrize("share", [0.0, 0.5])
def test_data_are_made_once_where_times_are_not_known(
    seconds: dict[Task, float], known: Durations, workers: int, share: float
) -> None:
    names = sorted({task.dataset for task in known.known})[: int(40 * share)]
    some = Durations({task: took for task, took in known.known.items() if task.dataset in names})
    hands = run(seconds, some, workers)
    assert set(hands.made.values()) == {1}
    ideal = max(sum(seconds.values()) / workers, longest_chain(seconds))
    assert ideal / hands.now >= 0.6


def one_each(tasks: Sequence[Task]) -> float:
    return float(len(tasks))


def test_what_shares_data_is_never_cut_and_comes_together() -> None:
    shared = [task("a", "quiet"), task("a", ON_BENCH), task("a", "quiet")]
    other = task("a", "noisy")
    mixed = [shared[0], other, *shared[1:]]
    assert cut(mixed, one_each, 1.0) == [tuple(shared), (other,)]


def test_a_bundle_is_of_one_data_set_and_of_as_much_as_may_be() -> None:
    some = [task(name, "quiet", unit) for name in "ab" for unit in range(5)]
    assert [len(bundle) for bundle in cut(some, one_each, 2.0)] == [2, 2, 1, 2, 2, 1]
    assert [len(bundle) for bundle in cut(some, one_each, float("inf"))] == [5, 5]
    assert cut([], one_each, 2.0) == []


def test_the_longest_waits_least_and_of_equal_ones_the_earliest() -> None:
    bundles = [
        Bundle((task(name, "quiet"),), takes) for name, takes in zip("abc", (1, 2, 2), strict=True)
    ]
    waiting = WaitingBundles(bundles)
    assert [waiting.take() for _ in bundles] == [bundles[1], bundles[2], bundles[0]]
    assert len(waiting) == 0


def test_times_that_are_not_known_are_those_of_their_like() -> None:
    durations = Durations()
    here, elsewhere = task("a", "quiet"), task("b", "quiet")
    assert durations.seconds([here]) == 1.0
    durations.add(elsewhere, Took(0, 1, 3.0))
    assert durations.seconds([here]) == 3.0
    durations.add(here, Took(0, 1, 5.0))
    assert durations.seconds([here]) == 5.0
    assert durations.seconds([task("a", "quiet", 1)]) == 5.0
    assert durations.seconds_of_rest([here]) == 0.0
    assert durations.seconds_of_rest([task("a", "noisy")]) == 5.0
