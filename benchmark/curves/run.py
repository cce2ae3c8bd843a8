"""Bringing the learning curves up to date: what has changed is measured, all else stays.

A worker takes a data set with all of its leaders. Rows are pure functions of names, code and data,
and written in one order: the file is the same for any number of workers.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, nullcontext
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from benchmark.contract import Cell
from benchmark.curves import record
from benchmark.curves.leaders import Leader, leaders
from benchmark.curves.measure import Learnt, Task, measure
from benchmark.curves.outcome import row_of
from benchmark.plan.parts import Parts, installed
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.components import Components, current
from benchmark.results.store import PUBLISHED, Store
from benchmark.running.workers import as_completed
from files.locks import lock_or_refuse


@dataclass(frozen=True)
class Summary:
    """What was done: pipelines in all, and measured now; seconds."""

    planned: int
    computed: int
    seconds: float


def wanted(store: Store, parts: Parts) -> list[Leader]:
    """Return the pipelines that have a curve, by the scores of a store."""
    first = {name: preset.conditions[0] for name, preset in parts.presets.items()}
    return leaders(store.rows(), first)


def behind(
    directory: Path | str = PUBLISHED, parts: Parts | None = None
) -> list[tuple[Leader, str]]:
    """List the pipelines whose curve is not of code, data and board as they are, and why.

    Nothing is measured, and nothing asked where no curves are stored at all.

    Raises
    ------
    StoreError, ComponentsError
        For a file that cannot be read.
    """
    stored = record.read(directory)
    if not stored:
        return []
    known = parts or installed()
    found = wanted(Store(directory), known)
    return list(record.stale(stored, found, _components(known, found)))


def update(
    directory: Path | str = PUBLISHED,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    parts: Parts | None = None,
) -> Summary:
    """Measure what is missing or out of date, drop what no longer leads, write the file.

    The file is written after every data set, so that a call that is broken off is gone on with.

    Parameters
    ----------
    directory
        Of the record, whose scores say what leads.
    workers
        Number of processes; the file does not depend on it.
    progress
        As `benchmark.running.run.run`, in pipelines.
    parts
        Data sets and implementations; those installed by default.

    Raises
    ------
    ValueError
        For less than one worker.
    StoreError, ComponentsError
        For a file that cannot be read.
    LockedError
        When another process brings them up to date.
    """
    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
    with lock_or_refuse(Path(directory) / record.NAME):
        return _updated(directory, workers, progress, parts)


def _updated(
    directory: Path | str, workers: int, progress: ProgressCallback | None, parts: Parts | None
) -> Summary:
    started = time.perf_counter()
    known, store = parts or installed(), Store(directory)
    leading = wanted(store, known)
    components = _components(known, leading)
    stored = record.read(directory)
    old = {leader for leader, _ in record.stale(stored, leading, components)}
    rows = {leader: stored[leader] for leader in leading if leader not in old}
    missing = [leader for leader in leading if leader in old]
    bounds, pins = _bounds(store, leading), store.pins()
    code = record.code_digest()
    with terminal_progress("learning") if progress is None else nullcontext(progress) as report:
        report(0, len(missing), "")
        done = 0
        for learnt in _measured(tasks_of(missing, known, store), workers):
            for one in learnt:
                key = record.key_of(one.leader, components, code)
                pin = pins.get((one.leader.dataset, one.leader.condition, "test"))
                row = row_of(one, bounds[one.leader], pin.bench_deg if pin else None)
                rows[one.leader] = {**row, "key": key}
            done += len(learnt)
            report(done, len(missing), learnt[0].leader.dataset)
            record.write(rows.values(), directory)
    record.write(rows.values(), directory)
    return Summary(len(leading), len(missing), time.perf_counter() - started)


def tasks_of(missing: Sequence[Leader], parts: Parts, store: Store) -> list[Task]:
    """Make a task of each data set's leaders, which stand together.

    Parameters
    ----------
    missing
        Sorted.
    parts
        Data sets and implementations.
    store
        Whose pins say where every direction is observable.

    Raises
    ------
    UnknownNameError
        For a pipeline whose names are not installed.
    """
    pins = store.pins()
    tasks = []
    for name, group in groupby(missing, key=lambda leader: leader.dataset):
        found = tuple(group)
        pin = pins.get((name, found[0].condition, "test"))
        tasks.append(
            Task(
                parts.preset(name),
                found,
                {leader.extractor: parts.extractor(leader.extractor) for leader in found},
                {leader.model: parts.model(leader.model) for leader in found},
                all_observable=pin is not None and pin.observable == pin.n,
            )
        )
    return tasks


def _components(parts: Parts, found: Sequence[Leader]) -> Components:
    """Digests of what leads only: all of them would take seconds."""

    def named(kind: Mapping[str, Any], names: set[str]) -> dict[str, Any]:
        return {name: value for name, value in kind.items() if name in names}

    return current(
        Parts(
            named(parts.presets, {leader.dataset for leader in found}),
            named(parts.extractors, {leader.extractor for leader in found}),
            named(parts.models, {leader.model for leader in found}),
        )
    )


def _bounds(store: Store, found: Sequence[Leader]) -> dict[Leader, float]:
    """Bound of each leader's score: of a unit known by its references, where there is one."""
    scores, bounds = store.scores(), {}
    for leader in found:
        row = scores[Cell(leader.dataset, leader.condition, leader.extractor, leader.model)]
        unit = row["bound_unit_deg"]
        bounds[leader] = row["bound_deg"] if unit is None else unit
    return bounds


def _measured(tasks: Sequence[Task], workers: int) -> Iterator[list[Learnt]]:
    with closing(as_completed(measure, tasks, workers if len(tasks) > 1 else 1)) as found:
        yield from found
