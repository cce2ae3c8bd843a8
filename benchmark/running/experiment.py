"""What an experiment declares, and the one way in which all of them are planned and measured.

An experiment is a module of `benchmark.experiments` with one class: its *cells* (what is to be
measured), its *measure* (numbers of some cells that share work, in one worker) and either a file of
the record, in which a row stays until the digest of what it depends on changes, with the *pictures*
that are drawn of it (`Recorded`), or lines that are printed (`Report`). Rows depend on the cell
alone, never on time, machine or number of workers.
"""

from __future__ import annotations

import hashlib
import importlib
import math
import pkgutil
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, nullcontext
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Generic

from benchmark.contract import UnknownNameError
from benchmark.plan.parts import Parts, installed_parts
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.row_file import C, Row, RowFile, TableFile
from benchmark.results.store import PUBLISHED
from files.locks import lock_or_refuse

#: Numbers of another processor may differ by this share.
RELATIVE_TOLERANCE = 2e-4


class Experiment(ABC, Generic[C]):
    """One thing that is measured.

    Parameters
    ----------
    directory
        Of the record, whose scores may say what is to be measured.
    parts
        Data sets and implementations; those installed by default.

    Attributes
    ----------
    name
        As the command line knows it.
    """

    name: ClassVar[str]

    def __init__(self, directory: Path | str = PUBLISHED, parts: Parts | None = None) -> None:
        self.directory = Path(directory)
        self._parts = parts

    @cached_property
    def parts(self) -> Parts:
        """Data sets and implementations."""
        return self._parts or installed_parts()

    @abstractmethod
    def cells(self) -> Sequence[C]:
        """List what is to be measured, in order."""

    @abstractmethod
    def tasks(self, cells: Sequence[C]) -> Iterable[Any]:
        """Group cells, in order, by the work that they share: a worker is given one task."""

    @staticmethod
    @abstractmethod
    def measure(task: Any) -> list[tuple[Any, Row]]:
        """Return the rows of a task by cell; a pure function, run in a worker process."""

    def name_of(self, cell: C) -> str:
        """Return the word by which a caller asks for a cell; several cells may share it."""
        return str(cell)

    def cells_named(self, names: Collection[str]) -> list[C]:
        """Return the cells of these names."""
        known: dict[str, list[C]] = {}
        for cell in self.cells():
            known.setdefault(self.name_of(cell), []).append(cell)
        for name in names:
            if name not in known:
                raise UnknownNameError(f"cell of {self.name}", name, known)
        return [cell for name in known if name in names for cell in known[name]]


class RecordedExperiment(Experiment[C]):
    """An experiment whose rows are kept in the record.

    Attributes
    ----------
    record
        The file.
    title
        Heading of its page.
    """

    record: ClassVar[RowFile[Any] | TableFile[Any]]
    title: ClassVar[str]

    @abstractmethod
    def keys(self) -> Mapping[C, str]:
        """Return, by cell, a digest of all that its row depends on."""

    def cells(self) -> Sequence[C]:
        """List what is to be measured, in order."""
        return list(self.keys())

    def why_outdated(self, row: Row, key: str) -> str:
        """Say why a row is not of this key; empty where it is."""
        return "" if row["key"] == key else "of other code or data"

    def pictures(self) -> Mapping[str, Callable[[], str]]:
        """Return what draws the record as SVG, by the name of the file."""
        return {}

    def rows(self) -> list[Row]:
        """Return the rows of the record in order, without digests."""
        return [
            {name: value for name, value in row.items() if name != "key"}
            for row in self.record.read(self.directory).values()
        ]

    def table(self) -> list[Row]:
        """Return the rows as a table of numbers and texts, without members that are neither."""
        return [
            {
                name: value
                for name, value in row.items()
                if isinstance(value, str) or not isinstance(value, Mapping | Sequence)
            }
            for row in self.rows()
        ]

    def comparable_members(self, row: Row) -> Row:
        """Return those members of a row that another run repeats."""
        return {name: value for name, value in row.items() if name != "key"}


class Report(Experiment[C]):
    """An experiment that keeps nothing: its rows are printed."""

    @abstractmethod
    def lines(self, rows: Mapping[C, Row]) -> Iterator[str]:
        """Yield what is printed."""

    def passes(self, rows: Mapping[C, Row]) -> bool:  # noqa: ARG002 - subclasses read it
        """Say whether the rows are as they should be."""
        return True


@dataclass(frozen=True)
class ExperimentSummary:
    """What was done: cells in all, and measured now; seconds."""

    planned: int
    computed: int
    seconds: float


def experiments() -> dict[str, type[RecordedExperiment[Any] | Report[Any]]]:
    """Return every experiment by name."""
    package = importlib.import_module("benchmark.experiments")
    found: dict[str, type[RecordedExperiment[Any] | Report[Any]]] = {}
    for info in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
        if info.name.endswith("__main__"):
            continue
        module = importlib.import_module(info.name)
        defined = [
            value
            for value in vars(module).values()
            if isinstance(value, type)
            and issubclass(value, RecordedExperiment | Report)
            and value.__module__ == module.__name__
        ]
        if len(defined) != 1:
            raise ValueError(f"{info.name}: expected one experiment, got {len(defined)}")
        found[defined[0].name] = defined[0]
    return found


def recorded_experiments() -> dict[str, type[RecordedExperiment[Any]]]:
    """Return by name every experiment whose rows are kept."""
    return {
        name: kind for name, kind in experiments().items() if issubclass(kind, RecordedExperiment)
    }


def list_due(experiment: RecordedExperiment[C]) -> list[tuple[C, str]]:
    """List the cells whose row is missing, out of date or no longer wanted, sorted, and why."""
    return list(_due(experiment, experiment.record.read(experiment.directory), experiment.keys()))


def _due(
    experiment: RecordedExperiment[C], stored: Mapping[C, Row], keys: Mapping[C, str]
) -> Iterator[tuple[C, str]]:
    for cell in sorted(stored.keys() | keys.keys()):  # type: ignore[type-var]
        if cell not in keys:
            yield cell, "no longer wanted"
        elif cell not in stored:
            yield cell, "absent"
        elif reason := experiment.why_outdated(stored[cell], keys[cell]):
            yield cell, reason


def update(
    experiment: RecordedExperiment[C],
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    only: Collection[C] | None = None,
) -> ExperimentSummary:
    """Measure what is due, drop what is no longer wanted, write the file.

    It is written after every task, so that a call that is broken off is gone on with.
    `only` are cells that are measured instead, due or not.
    HeldError when another process brings the experiment up to date.
    """
    _require_workers(workers)
    started = time.perf_counter()
    record, directory = experiment.record, experiment.directory
    directory.mkdir(parents=True, exist_ok=True)
    with lock_or_refuse(directory / record.name):
        keys, stored = experiment.keys(), record.read(directory)
        old = {cell for cell, _ in _due(experiment, stored, keys)}
        missing = [cell for cell in keys if cell in (old if only is None else only)]
        rows = {cell: row for cell, row in stored.items() if cell in keys}
        if only is None:
            rows = {cell: row for cell, row in rows.items() if cell not in old}
        for found in measure_tasks(experiment, missing, workers, progress):
            for cell, row in found:
                rows.pop(cell, None)  # what is new stands last
                rows[cell] = {**row, "key": keys[cell]}
            record.write(rows, directory)
        if rows.keys() != stored.keys():
            record.write(rows, directory)
    return ExperimentSummary(len(keys), len(missing), time.perf_counter() - started)


def measure_tasks(
    experiment: Experiment[C],
    cells: Sequence[C],
    workers: int = 1,
    progress: ProgressCallback | None = None,
) -> Iterator[list[tuple[C, Row]]]:
    """Measure cells and yield the rows of each task as soon as they are there, in any order.

    Parameters as `update`.
    """
    from benchmark.running.workers import as_completed  # noqa: PLC0415 - slow to load

    _require_workers(workers)
    tasks = list(experiment.tasks(cells)) if cells else []
    shown = terminal_progress(experiment.name) if progress is None else nullcontext(progress)
    with shown as report:
        report(0, len(cells), "")
        done = 0
        work = type(experiment).measure
        with closing(as_completed(work, tasks, workers if len(tasks) > 1 else 1)) as results:
            for found in results:
                yield found
                done += len(found)
                report(done, len(cells), experiment.name_of(found[0][0]) if found else "")


def draw_cells(cells: Iterable[C], sample: int, seed: int) -> list[C]:
    """Draw `sample` of the cells, or all where there are fewer, in order.

    Each cell's lot is a digest of the seed and its name: what else is in the record moves none.
    """
    if sample < 1:
        raise ValueError(f"sample must be at least 1; got {sample}")

    def lot(cell: C) -> bytes:
        return hashlib.sha256(f"{seed} {cell}".encode()).digest()

    return sorted(sorted(set(cells), key=lot)[:sample])  # type: ignore[type-var]


def repeat_at_random(
    experiment: RecordedExperiment[C], sample: int, seed: int, workers: int = 1
) -> Iterator[tuple[C, str]]:
    """Measure cells drawn at random again, and yield what is not as the record has it."""
    stored = experiment.record.read(experiment.directory)
    drawn = draw_cells(stored.keys() & set(experiment.cells()), sample, seed)
    for found in measure_tasks(experiment, drawn, workers):
        for cell, row in found:
            one, other = (
                experiment.comparable_members(stored[cell]),
                experiment.comparable_members(row),
            )
            for place, text in differences(one, other):
                yield cell, f"{place}{text}"


def differences(known: Any, again: Any, place: str = "") -> Iterator[tuple[str, str]]:
    """Yield (place, what differs) of two JSON values; numbers may differ by the tolerance."""
    if isinstance(known, Mapping) and isinstance(again, Mapping):
        for name in dict.fromkeys((*known, *again)):
            yield from differences(known.get(name), again.get(name), f"{place}{name}, ")
    elif isinstance(known, list) and isinstance(again, list) and len(known) == len(again):
        for number, (one, other) in enumerate(zip(known, again, strict=True), start=1):
            yield from differences(one, other, f"{place}{number}, ")
    elif not _alike(known, again):
        yield place, f"is {known!r}; measured again it is {again!r}"


def _alike(one: Any, other: Any) -> bool:
    if isinstance(one, int | float) and isinstance(other, int | float):
        return math.isclose(one, other, rel_tol=RELATIVE_TOLERANCE, abs_tol=1e-12)
    return bool(one == other)


def _require_workers(workers: int) -> None:
    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
