"""Measure cells into a store: in parallel, resumable, never twice what is already there.

A unit is one (dataset, condition, extractor); a worker takes a few that share samples. Only this
process writes, and what a worker hands back is on disk before the next is awaited, so a killed run
loses what was in flight and nothing else. Numbers do not depend on the number of workers.
"""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Iterable
from contextlib import nullcontext
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from itertools import groupby
from pathlib import Path

from benchmark.content_key import Specifications
from benchmark.plan import Cell
from benchmark.plan_parts import SPLITS, Parts, installed
from benchmark.runner_backend import outcomes
from benchmark.runner_progress import ProgressCallback, terminal_progress
from benchmark.runner_rows import Keys, run_row, score_row
from benchmark.runner_unit import Outcome, Unit, UnitResult
from benchmark.store import Pin, Row, Store, cell_of, collector_paused
from benchmark.store_journal import Journal, Progress, locked


@dataclass(frozen=True)
class Summary:
    """What a run did."""

    store: Path
    planned: int
    already_stored: int
    computed: int
    failed: tuple[tuple[Cell, str], ...]
    warnings: tuple[str, ...]
    seconds: float


class RunInterruptedError(KeyboardInterrupt):
    """Ctrl-C during a run; the message says what is kept."""


def run(
    cells: Iterable[Cell],
    store: Store,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    scheduler: str | None = None,
    only_these: bool = False,
    parts: Parts | None = None,
    specifications: Specifications | None = None,
) -> Summary:
    """Measure the cells that the store does not hold yet.

    Parameters
    ----------
    cells
        What to measure, as planned by `benchmark.plan.cells`.
    store
        Where results go.
    workers
        Number of processes; 1 measures in this one.
    progress
        Called as ``progress(done, total, what)`` in cells; by default a bar on standard error
        when that is a terminal.
    scheduler
        Address of a Dask scheduler to measure on instead.
    only_these
        Drop stored results of cells that are not among `cells` (a full run); otherwise they stay.
    parts
        Datasets and implementations; what is installed by default.
    specifications
        Digests of datasets to share with other calls of the same run.

    Raises
    ------
    UnknownNameError
        For a cell whose names are not installed.
    StoreLockedError
        When another runner writes to the store.
    DaskMissingError
        When a scheduler is given and ``distributed`` is not installed.
    RunInterruptedError
        On Ctrl-C; what was measured is kept and not measured again.
    """
    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
    started = time.perf_counter()
    wanted = sorted(set(cells))
    parts = parts or installed()
    keys = Keys(parts, specifications)
    with locked(store):
        journal = Journal(store)
        journal.cut_torn_line()
        with collector_paused():
            known = journal.progress()
            missing = [cell for cell in wanted if not _is_stored(cell, known, keys)]
        recorder = _Recorder(journal, known, keys)
        if missing:
            results = outcomes(_units(missing, parts), workers, scheduler)
            with terminal_progress() if progress is None else nullcontext(progress) as report:
                recorder.record(results, len(missing), report)
        _finalise(store, journal, known, parts, wanted if only_these else None)
    return Summary(
        store=store.directory,
        planned=len(wanted),
        already_stored=len(wanted) - len(missing),
        computed=len(missing),
        failed=tuple(
            (cell, known.rows[cell]["reason"])
            for cell in wanted
            if known.rows[cell]["status"] == "failed"
        ),
        warnings=tuple(recorder.warnings),
        seconds=time.perf_counter() - started,
    )


def stale(
    cells: Iterable[Cell],
    store: Store,
    *,
    parts: Parts | None = None,
    specifications: Specifications | None = None,
) -> list[Cell]:
    """List the cells that the store does not hold as code and data now are; renders nothing."""
    known = Journal(store).progress()
    keys = Keys(parts or installed(), specifications)
    return [cell for cell in sorted(set(cells)) if not _is_stored(cell, known, keys)]


def _is_stored(cell: Cell, known: Progress, keys: Keys) -> bool:
    row = known.rows.get(cell)
    if row is None or row["status"] == "failed":
        return False
    data_hash = keys.pinned_hash(cell, known.pins)
    return data_hash is not None and row["key"] == keys.key(cell, data_hash)


def _units(cells: list[Cell], parts: Parts) -> list[Unit]:
    """Cells in units, those of one dataset and condition in a row so that samples are shared."""
    return [
        Unit(
            parts.preset(dataset),
            condition,
            parts.extractor(extractor),
            tuple(parts.model(cell.model) for cell in group),
        )
        for (dataset, condition, extractor), group in groupby(
            sorted(cells), key=lambda cell: (cell.dataset, cell.condition, cell.extractor)
        )
    ]


class _Recorder:
    """The coordinator's side: every finished unit goes to the journal, then into what is known."""

    def __init__(self, journal: Journal, known: Progress, keys: Keys) -> None:
        self.warnings: list[str] = []
        self._journal = journal
        self._known = known
        self._keys = keys

    def record(self, results: Iterable[UnitResult], total: int, report: ProgressCallback) -> None:
        done = 0
        report(done, total, "")
        try:
            for result in results:
                self._keep(result)
                done += len(result.outcomes)
                unit = result.unit
                report(done, total, f"{unit.preset.name} {unit.condition} {unit.extractor.name}")
        except KeyboardInterrupt as error:
            raise RunInterruptedError(
                f"interrupted with {done} of {total} cells measured; they are kept in "
                f"{self._journal.path} and not measured again by the next run"
            ) from error

    def _keep(self, result: UnitResult) -> None:
        renewed = self._renewed_pins(result)
        pins = {**self._known.pins, **{pin.place: pin for pin in renewed}}
        finished = [self._rows(result, outcome, pins) for outcome in result.outcomes]
        self._journal.append(renewed, finished)
        self._known.pins = pins
        for score, times in finished:
            self._known.rows[cell_of(score)] = score
            self._known.runs[times["key"]] = times

    def _renewed_pins(self, result: UnitResult) -> list[Pin]:
        """Pins to renew. One made by the same code is kept; a different hash is reported."""
        renewed = []
        for pin in result.pins:
            pinned = self._known.pins.get(pin.place)
            if pinned is None or pinned.specification != pin.specification:
                renewed.append(pin)
            elif pinned.data_hash != pin.data_hash:
                message = (
                    f"{pin.dataset} {pin.condition} {pin.split}: data hash {pin.data_hash} on "
                    f"this machine, pinned {pinned.data_hash}; scores agree within tolerance only"
                )
                if message not in self.warnings:
                    self.warnings.append(message)
        return renewed

    def _rows(
        self, result: UnitResult, outcome: Outcome, pins: dict[tuple[str, str, str], Pin]
    ) -> tuple[Row, Row]:
        cell = _cell(result, outcome.model)
        key = self._keys.key(cell, self._keys.pinned_hash(cell, pins))
        measured = self._keys.joined({pin.split: pin.data_hash for pin in result.pins})
        return (
            score_row(key, measured, result, outcome),
            run_row(key, cell, result, outcome, environment()),
        )


def _cell(result: UnitResult, model: str) -> Cell:
    unit = result.unit
    return Cell(unit.preset.name, unit.condition, unit.extractor.name, model)


def _finalise(
    store: Store, journal: Journal, known: Progress, parts: Parts, keep: list[Cell] | None
) -> None:
    """Write the store's files, where something was measured or is to be dropped."""
    rows, pins = known.rows, known.pins
    if keep is not None:
        kept = frozenset(keep)
        rows = {cell: row for cell, row in rows.items() if cell in kept}
        # datasets that nothing can be measured on are pinned too (benchmark.data_pins)
        conditions = {name: preset.conditions for name, preset in parts.presets.items()}
        pins = {
            place: pin
            for place, pin in pins.items()
            if place[1] in conditions.get(place[0], ()) and place[2] in SPLITS
        }
    current = {row["key"] for row in rows.values()}
    runs = [run for key, run in known.runs.items() if key in current]
    counts = len(rows), len(pins), len(runs)
    if journal.exists() or counts != (len(known.rows), len(known.pins), len(known.runs)):
        store.write(rows.values(), runs, pins.values())
        journal.remove()
    known.rows, known.pins = rows, pins


@cache
def environment() -> Row:
    """Where times were taken: kept beside them, never part of a key."""
    libraries = ("numpy", "scipy", "opencv-python-headless", "numba", "pandas", "joblib")
    return {
        "machine": platform.machine(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
        "libraries": {name: version(name) for name in libraries},
    }


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor()
