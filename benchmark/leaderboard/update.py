"""Bringing the published record up to date: scores, pins, sweeps, and the page beside them."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

from benchmark.contract import Cell
from benchmark.experiments.sweeps import Sweeps
from benchmark.leaderboard import scope
from benchmark.leaderboard.board import board_of
from benchmark.leaderboard.pages import PAGE, page
from benchmark.plan.parts import Parts, installed_parts
from benchmark.progress import ProgressCallback
from benchmark.results import record_manifest
from benchmark.results.components import Components, current
from benchmark.results.csv_tables import Row
from benchmark.results.record import open_record
from benchmark.results.store import PUBLISHED, Store
from benchmark.running import experiment, pinning
from benchmark.running.runner import Summary, failures, kept_beside, measure_missing

#: From scores and parts to what follows from them.
Choose = Callable[[Mapping[Cell, Row], Parts], list[Cell]]


def update(
    directory: Path | str = PUBLISHED,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    scheduler: str | None = None,
    parts: Parts | None = None,
) -> Summary:
    """Measure what is missing or out of date, drop what is no longer planned, write the record.

    Pipelines are scored by the rule of `benchmark.leaderboard.scope`; every dataset's data are
    pinned, whether anything can be measured on them or not; every extractor is measured on the
    reference features (`benchmark.sweeps`).

    Other parameters and errors as `benchmark.running.runner.run`; the numbers do not depend on the
    number of workers. UnversionedChangeError where data or bounds changed while their dataset's
    version did not: the first samples are looked at before anything is measured, and nothing is
    written.
    """
    started = time.perf_counter()
    known = parts or installed_parts()
    first, studied = scope.first(known), scope.studied_pipelines(known)
    store = Store(directory)
    measured = measure_scope(
        *(store, known, first, partial(scope.followers, studied=studied), started),
        workers=workers,
        progress=progress,
        scheduler=scheduler,
    )
    sweeps = Sweeps(store.directory, known)
    experiment.update(sweeps, workers, progress)
    write_page(store)
    failed = (
        f"sweep {point} failed: {row['reason']}"
        for point, row in sweeps.record.read(store.directory).items()
        if row["status"] == "failed"
    )
    seconds = time.perf_counter() - started
    return replace(measured, warnings=(*measured.warnings, *failed), seconds=seconds)


def measure_scope(
    store: Store,
    known: Parts,
    first: list[Cell],
    choose: Choose,
    started: float,
    *,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    scheduler: str | None = None,
) -> Summary:
    """Bring the scores and pins of a record up to date, and drop what is not of its scope.

    `started` is when the caller began, by `time.perf_counter`.
    """
    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
    components = current(known)
    kept = kept_beside(store, components)
    with open_record(store) as record:
        pinned = store.pins()
        _require_heads(store, known, components, workers)

        def measured(wanted: Iterable[Cell]) -> int:
            return measure_missing(
                wanted,
                record,
                components,
                known,
                workers=workers,
                progress=progress,
                scheduler=scheduler,
                kept=kept,
            )

        computed = measured(first)
        followers = choose(record.scores, known)
        computed += measured(followers)
        pins = pinning.pin_missing(record, components, known, workers=workers, progress=progress)
        pinning.require_versions(pinned, record.pins.values())
        wanted = frozenset((*first, *followers))
        record.drop(scores=wanted.__contains__, pins=frozenset(pinning.places(known)).__contains__)
        record.write(components)
        failed = failures(sorted(wanted), record)
    return Summary(
        store=store.directory,
        planned=len(wanted),
        already_stored=len(wanted) - computed,
        computed=computed,
        failed=failed,
        warnings=pins.warnings,
        seconds=time.perf_counter() - started,
    )


def _require_heads(store: Store, parts: Parts, components: Components, workers: int) -> None:
    """Compare the first samples of datasets whose code has changed with what was pinned of them."""
    changed = pinning.presets_of_other_code(store, parts, components)
    heads = pinning.changed_heads(store.pins(), changed, workers)
    if heads:
        raise pinning.UnversionedChangeError(heads)


def write_page(store: Store) -> bool:
    """Write the page of the best pipelines beside the record; True when it changed."""
    return record_manifest.write(store.directory, {PAGE: page(board_of(store))})
