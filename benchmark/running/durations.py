"""How long tasks took on this machine, so that a plan can say how long it will: never published.

A row a task, in seconds of one processor. The first task of a data set, condition and unit that a
worker does also makes the data; it is marked.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import groupby
from statistics import fmean, median
from typing import NamedTuple, Self

from benchmark.contract import Cell
from benchmark.results.csv_tables import number, parse_whole, read_csv, text_of, word
from benchmark.results.store import Store
from benchmark.running.task import Task
from files.atomic import replace_file

#: Name of the file, beside a store's journal.
DURATIONS = "durations.csv"

_COLUMNS = {
    "dataset": word,
    "condition": word,
    "unit": parse_whole,
    "extractor": word,
    "models": parse_whole,
    "made_data": parse_whole,
    "seconds": number,
}


class ExtractionTask(NamedTuple):
    """What a task is of."""

    dataset: str
    condition: str
    unit: int
    extractor: str

    @classmethod
    def of(cls, cell: Cell) -> Self:
        """Return the task that a cell is measured by."""
        return cls(cell.dataset, cell.condition, cell.unit, cell.extractor)


@dataclass(frozen=True)
class Took:
    """How long a task took.

    Attributes
    ----------
    models
        How many were scored.
    made_data
        1 where the data were made, too; else 0.
    seconds
        Of one processor.
    """

    models: int
    made_data: int
    seconds: float


@dataclass(frozen=True)
class Estimate:
    """How long measuring takes.

    Attributes
    ----------
    seconds
        Of one processor, for the tasks whose like was measured here.
    tasks, unknown
        How many tasks there are, and of how many nothing alike was measured here.
    """

    seconds: float
    tasks: int
    unknown: int


@dataclass
class Durations:
    """What is known of how long tasks take, by task."""

    known: dict[ExtractionTask, Took] = field(default_factory=dict)

    @classmethod
    def read(cls, stores: Iterable[Store]) -> Durations:
        """Return what stores have kept; of a task in several the last; StoreError for no table."""
        found: dict[ExtractionTask, Took] = {}
        for store in stores:
            for _, row in read_csv(store.work_directory / DURATIONS, _COLUMNS):
                task = ExtractionTask(*(row.pop(name) for name in ExtractionTask._fields))
                found[task] = Took(**row)
        return cls(found)

    def add(self, task: Task, took: Took) -> None:
        """Take in how long a task took."""
        self.known[_name_of(task)] = took

    def learn(self, task: Task, took: Took) -> None:
        """Take in how long a task took where that is not known."""
        self.known.setdefault(_name_of(task), took)

    def of(self, dataset: str) -> Durations:
        """Return what is known of one data set."""
        return Durations({task: took for task, took in self.known.items() if task[0] == dataset})

    def seconds(self, tasks: Sequence[Task]) -> float:
        """Say how long tasks of one data set take, their data included.

        By the same tasks; else by their like on the same data set; else by the same extractor on
        others; else as long as the mean task of all; where nothing is known a second each.
        """
        wanted = {_name_of(task): len(task.models) for task in tasks}
        same = [self.known[task] for task in wanted if task in self.known]
        if len(same) == len(wanted):
            return sum(took.seconds for took in same)
        like = self.of(tasks[0].preset.name).known
        if like:
            return _of_dataset(list(wanted), wanted, like)
        return sum(map(self._elsewhere, wanted))

    def _elsewhere(self, wanted: ExtractionTask) -> float:
        known = [took for task, took in self.known.items() if task.extractor == wanted.extractor]
        return fmean(took.seconds for took in known or self.known.values() or [Took(0, 0, 1.0)])

    def seconds_of_rest(self, tasks: Sequence[Task]) -> float:
        """Say how long what else is known of the data set of these tasks takes.

        Where nothing is, as long as all that is known of a mean data set.
        """
        known = self.of(tasks[0].preset.name).known
        if self.known and not known:
            total = sum(took.seconds for took in self.known.values())
            return total / len({task.dataset for task in self.known})
        given = {_name_of(task) for task in tasks}
        return sum(took.seconds for task, took in known.items() if task not in given)

    def keep(self, store: Store) -> None:
        """Write all to a store's working directory."""
        rows = [{**task._asdict(), **asdict(took)} for task, took in sorted(self.known.items())]
        replace_file(store.work_directory / DURATIONS, text_of(list(_COLUMNS), rows))

    def seconds_by_task(self, cells: Iterable[Cell]) -> dict[ExtractionTask, float]:
        """Return the seconds of each task of cells, of an unknown one those usual on its data set.

        Where nothing on the data set is known, those usual on all; nothing where none is known.
        """
        of_dataset: dict[str, list[float]] = {}
        for task, took in self.known.items():
            of_dataset.setdefault(task.dataset, []).append(took.seconds)
        usual = {dataset: median(seconds) for dataset, seconds in of_dataset.items()}
        if not usual:
            return {}
        of_all = median(usual.values())
        found = {}
        for task in {ExtractionTask.of(cell) for cell in cells}:
            known = self.known.get(task)
            found[task] = known.seconds if known else usual.get(task.dataset, of_all)
        return found

    def estimate(self, cells: Iterable[Cell]) -> Estimate:
        """Say how long cells take: by the same task, else by its like on the same data set."""
        tasks: dict[ExtractionTask, int] = {}
        for cell in cells:
            task = ExtractionTask.of(cell)
            tasks[task] = tasks.get(task, 0) + 1
        seconds, unknown = 0.0, 0
        for dataset, group in groupby(sorted(tasks), key=lambda task: task.dataset):
            like = {task: took for task, took in self.known.items() if task.dataset == dataset}
            if not like:
                unknown += len(list(group))
                continue
            seconds += _of_dataset(list(group), tasks, like)
        return Estimate(seconds, len(tasks), unknown)


def _name_of(task: Task) -> ExtractionTask:
    extractor = task.extractor.about.name
    return ExtractionTask(task.preset.name, task.condition, task.unit, extractor)


def _of_dataset(
    wanted: list[ExtractionTask],
    models: Mapping[ExtractionTask, int],
    like: Mapping[ExtractionTask, Took],
) -> float:
    """Return seconds of tasks on one data set, by what is known of it."""
    alone = [took.seconds for took in like.values() if not took.made_data]
    with_data = [took.seconds for took in like.values() if took.made_data]
    usual = median(alone) if alone else 0.0
    making = max(fmean(with_data) - usual, 0.0) if with_data else 0.0
    total = making * len({task[:3] for task in wanted})
    for task in wanted:
        same = [
            took
            for other, took in like.items()
            if not took.made_data and other.extractor == task.extractor
        ]
        exact = like.get(task)
        if exact is not None and not exact.made_data:
            same = [exact]
        total += (
            fmean(max(models[task] / max(took.models, 1), 1.0) * took.seconds for took in same)
            if (same)
            else usual
        )
    return total


def drop_unplanned(store: Store, planned: Collection[Cell]) -> int:
    """Forget how long tasks took that no cell is of any more; returns how many."""
    kept = Durations.read([store])
    wanted = {(cell.dataset, cell.condition, cell.extractor) for cell in planned}
    there = len(kept.known)
    kept.known = {
        task: took
        for task, took in kept.known.items()
        if (task.dataset, task.condition, task.extractor) in wanted
    }
    if len(kept.known) < there:
        kept.keep(store)
    return there - len(kept.known)
