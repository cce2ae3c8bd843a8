"""The schedule, simulated: data made once, and nearly nobody idle, with 2 to 64 workers.

`measured_durations.csv` holds the processor time of every data set's conditions and units, as
measured for the published record: of making the data, and of each extractor with its models; where
several units are named, the mean of theirs.
"""

from __future__ import annotations

import csv
import math
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import cache
from heapq import heappop, heappush
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fake_atlas
import pytest

from benchmark.contract import ON_BENCH, Cell
from benchmark.running import backend
from benchmark.running.backend import Done, Work, shared_out
from benchmark.running.durations import Durations, Took
from benchmark.running.schedule import Bundle, WaitingBundles, bundles, cut, pieces, place_of
from benchmark.running.task import Task, TaskResult

MEASURED = Path(__file__).parent / "measured_durations.csv"
#: Reading what is kept of data, as a share of making them: at most 0.11 on the nine data sets whose
#: data take longest.
READING = 0.12


def task(
    dataset: str, condition: str, unit: int = 0, first: str = "quiet", extractor: str = "one"
) -> Task:
    preset = fake_atlas.Diodes(name=dataset, conditions=(first,))
    return Task(preset, condition, named(extractor), (), unit)


@cache
def named(name: str) -> Any:
    """Return an extractor of a name."""
    about = replace(fake_atlas.Currents.about, name=name)
    return type("Named", (fake_atlas.Currents,), {"about": about})


@dataclass
class Times:
    """What tasks take, seconds: by task, and by place to make the data."""

    tasks: dict[Task, float]
    data: dict[Any, float]

    def total(self) -> float:
        return sum(self.tasks.values()) + sum(self.data.values())


@pytest.fixture(scope="module")
def times() -> Times:
    """Every task of the record with its time."""
    found = Times({}, {})
    with MEASURED.open() as file:
        for row in csv.DictReader(file):
            for unit in map(int, row["units"].split()):
                for told in row["task_seconds"].split():
                    extractor, _, seconds = told.partition(":")
                    one = task(row["dataset"], row["condition"], unit, "nominal", extractor)
                    found.tasks[one] = float(seconds)
                if row["condition"] != ON_BENCH:
                    found.data[place_of(one)] = float(row["data_seconds"])
    return found


class Workers:
    """Workers of a clock that goes from one end of a bundle to the next; what they make is kept."""

    def __init__(self, workers: int, times: Times) -> None:
        self.idle = workers
        self.now = 0.0
        self.made: Counter[Any] = Counter()
        self._times = times
        self._kept: dict[Any, float] = {}
        self._under_way: list[tuple[float, int, Done]] = []
        self._given = 0

    def is_free(self) -> bool:
        return self.idle > 0

    def is_busy(self) -> bool:
        return bool(self._under_way)

    def give(self, work: Work) -> None:
        self._clock, self._seen = self.now, set[Any]()
        done = work()
        self._given += 1
        self.idle -= 1
        heappush(self._under_way, (self._clock, self._given, done))

    def take(self) -> Done:
        self.now, _, done = heappop(self._under_way)
        self.idle += 1
        return done

    def process_time(self) -> float:
        return self._clock

    def measure(self, task: Task, _: Any) -> TaskResult:
        place = place_of(task)
        if place not in self._seen:
            making = self._times.data[place]
            if self._is_kept(place):
                self._clock += READING * making
            else:
                self.made[place] += 1
                self._clock += making
                self._kept[place] = self._clock
        self._seen.add(place)
        self._clock += self._times.tasks[task]
        return TaskResult(task, (), ())

    def has(self, _: str, cell: Cell) -> bool:
        return self._is_kept((cell.dataset, cell.unit, cell.condition))

    def _is_kept(self, place: Any) -> bool:
        return self._kept.get(place, math.inf) <= self._clock


def run(times: Times, durations: Durations, workers: int, *, kept: bool = True) -> Workers:
    """Simulate measuring all from nothing: what follows of a data set is known after its first."""
    first = [task for task in times.tasks if task.condition == "nominal" and task.unit == 0]

    def following(dataset: str) -> Callable[[Collection[TaskResult]], list[Task]]:
        mine = [task for task in times.tasks if task.preset.name == dataset]
        before = {task for task in first if task.preset.name == dataset}
        after = [task for task in mine if task not in before]
        return lambda results: after if before <= {one.task for one in results} else []

    names = {one.preset.name for one in first}
    follow_ups: Any = {name: SimpleNamespace(tasks=following(name)) for name in names}
    hands: Any = Workers(workers, times)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(backend, "measure", hands.measure)
        patch.setattr(backend, "time", hands)
        stages = hands if kept else None
        done = list(shared_out(first, hands, workers, follow_ups, durations, kept=stages))
    assert Counter(one for one, *_ in done) == Counter(times.tasks.keys())
    return hands


@pytest.fixture
def known(times: Times) -> Durations:
    """What an earlier run has told of times."""
    durations, seen = Durations(), set()
    for one, takes in times.tasks.items():
        place = place_of(one)
        making = 0.0 if place in seen else times.data[place]
        durations.add(one, Took(1, int(place not in seen), takes + making))
        seen.add(place)
    return durations


@pytest.mark.parametrize("workers", [2, 11, 64])
def test_speed_up_is_near_ideal_and_data_are_made_once(
    times: Times, known: Durations, workers: int
) -> None:
    hands = run(times, known, workers)
    assert set(hands.made.values()) == {1}
    assert hands.made.keys() == times.data.keys()
    ideal = times.total() / workers
    assert ideal / hands.now >= 0.8, f"{workers} workers: {hands.now:.1f} s; ideal {ideal:.1f} s"


def one_each(tasks: Sequence[Task]) -> float:
    return float(len(tasks))


def test_what_shares_data_is_never_cut_and_comes_together() -> None:
    shared = [task("a", "quiet"), task("a", ON_BENCH), task("a", "quiet")]
    other = task("a", "noisy")
    mixed = [shared[0], other, *shared[1:]]
    assert cut(mixed, one_each, 1.0) == [tuple(shared), (other,)]


def test_tasks_that_share_data_are_told_apart_by_extractor_where_data_are_kept() -> None:
    place = [task("a", "quiet", extractor=name) for name in "xyz"]
    place.insert(0, task("a", ON_BENCH, extractor="y"))
    assert pieces(place, one_each, 2.0) == [(place[0], place[2]), (place[1], place[3])]
    assert pieces(place, one_each, 9.0) == [(place[0], place[2], place[1], place[3])]
    durations = Durations()
    whole, apart = (bundles(place, durations, 2.0, apart=apart) for apart in (False, True))
    assert [(bundle.tasks, bundle.then) for bundle in whole] == [(tuple(place), ())]
    assert [bundle.tasks for bundle in (apart[0], *apart[0].then)] == pieces(place, one_each, 2.0)
    assert apart[0].seconds == 4.0, "as long as all that waits for it"


def test_what_follows_waits_for_all_first_tasks_of_a_data_set(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = [task("a", "quiet", extractor=name) for name in "xyz"]
    after = [task("a", "noisy")]
    times = Times(dict.fromkeys([*first, *after], 1.0), {place_of(t): 1.0 for t in first + after})
    follow_up: Any = SimpleNamespace(
        tasks=lambda results: after if set(first) <= {one.task for one in results} else []
    )
    hands: Any = Workers(2, times)
    monkeypatch.setattr(backend, "measure", hands.measure)
    monkeypatch.setattr(backend, "time", hands)
    found = list(shared_out(first, hands, 2, {"a": follow_up}, Durations(), kept=hands))
    assert [one for one, *_ in found] == [*first, *after]
    assert hands.now == pytest.approx(2.0 + READING + 1.0 + 2.0)
    assert hands.made == {place_of(first[0]): 1, place_of(after[0]): 1}


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
    assert durations.seconds_of_rest([task("c", "quiet")]) == 4.0, "all of a mean data set"
