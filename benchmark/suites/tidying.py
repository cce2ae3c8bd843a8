"""Dropping from a working store what no cell of today's code refers to."""

from __future__ import annotations

import shutil
from dataclasses import dataclass, replace
from pathlib import Path

from benchmark.contract import Cell
from benchmark.datasets.pins import Place
from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts, every_part
from benchmark.results.components import current
from benchmark.results.record import open_record
from benchmark.results.store import Store
from benchmark.running import pinning
from benchmark.running.fitting import data_condition
from files.atomic import temporary_directory


@dataclass(frozen=True)
class TidyResult:
    """What was dropped.

    Scores and pinned splits that went, scores that stay, and bytes that were freed.
    """

    scores: int
    pins: int
    kept: int
    freed: int


def tidy(store: Store, *, parts: Parts | None = None) -> TidyResult:
    """Drop scores and pins of code or data that have changed or are gone.

    StoreLockedError while a runner writes to the store; StoreError, ComponentsError for a broken
    file.
    """
    if not store.directory.is_dir():
        return TidyResult(0, 0, 0, 0)
    known = parts or every_part()
    components = current(known)
    before = _size(store)
    planned, places = frozenset(cells(parts=known)), frozenset(pinning.places(known))
    with open_record(store) as record:
        there = len(record.scores), len(record.pins)

        def is_current(cell: Cell) -> bool:
            preset = known.presets.get(cell.dataset)
            if preset is None:
                return False
            read = data_condition(preset, cell.condition)
            if replace(cell, unit=0, condition=read) not in planned:
                return False
            return record.why_outdated(cell, components) in ((), ("failed",))

        def is_pinned(place: Place) -> bool:
            return place in places and record.is_pinned(place, components)

        record.drop(scores=is_current, pins=is_pinned)
        record.write(components)
    return TidyResult(
        scores=there[0] - len(record.scores),
        pins=there[1] - len(record.pins),
        kept=len(record.scores),
        # a store without results grows by what is written about the code
        freed=max(before - _size(store), 0),
    )


def would_tidy(store: Store, *, parts: Parts | None = None) -> TidyResult:
    """Say what `tidy` would drop: it is done to a copy."""
    if not store.directory.is_dir():
        return TidyResult(0, 0, 0, 0)
    with temporary_directory() as temporary:
        copy = Store(temporary)
        for path in _files(store):
            place = copy.directory / path.relative_to(store.directory)
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, place)
        return tidy(copy, parts=parts)


def _files(store: Store) -> list[Path]:
    """List the files of a store: whatever else lies in its directory is nobody's garbage."""
    top = [store.pins_path, store.components_path]
    found = [*top, store.work_directory / "journal.jsonl", *store.scores_directory.glob("*.csv")]
    found += store.samples_directory.glob("*.parquet")
    return [path for path in found if path.is_file()]


def _size(store: Store) -> int:
    return sum(path.stat().st_size for path in _files(store))
