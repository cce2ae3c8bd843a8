"""Sweeps over noise, feature size, sub-pixel phase and more: error of every method, and its bound.

Rows live in ``sweeps.csv`` beside the scores. Like scores they depend on code only, never on time,
machine or number of workers; a row of the code as it is stays, so that bringing them up to date
measures what has changed.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, nullcontext
from dataclasses import astuple, dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from algorithms.contract import Extractor
from algorithms.discovery import discover_extractors
from benchmark.plan.parts import Parts
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.components import Components, current
from benchmark.results.digests import series_digest
from benchmark.results.record import Record, opened, point_of
from benchmark.results.store import PUBLISHED, SWEPT, Store
from benchmark.results.tables import Row
from benchmark.running.workers import as_completed
from benchmark.sweeps.measure import measure, refused_row
from benchmark.sweeps.plan import SERIES, Planned, Point, planned
from benchmark.synthetic_features.series import SWEEPS, Setting

Extractors = Mapping[str, type[Extractor]]

#: As `benchmark.leaderboard.check.RELATIVE_TOLERANCE`, and of samples at the edge of being found.
RELATIVE_TOLERANCE = 1e-4
_SAMPLES_TOLERANCE = 1.5


@dataclass(frozen=True)
class Swept:
    """What was measured.

    Attributes
    ----------
    planned, computed
        Points of all methods, and how many of them were measured now.
    failed
        Points at which a method failed, with the reason.
    seconds
        How long it took.
    """

    planned: int
    computed: int
    failed: tuple[tuple[Point, str], ...]
    seconds: float


def series_digests() -> dict[str, str]:
    """Digest of each series of reference features."""
    return {name: series_digest(series) for name, series in SERIES.items()}


def components_of(extractors: Extractors) -> Components:
    """Return what sweeps of these extractors are of, as the code now is."""
    return current(Parts({}, extractors, {}), series_digests())


def update(
    directory: Path | str = PUBLISHED,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    extractors: Extractors | None = None,
) -> Swept:
    """Measure what is missing or out of date, drop what is no longer planned, write the store.

    Parameters
    ----------
    directory
        Of the store.
    workers
        Number of processes; the rows do not depend on it.
    progress
        As `benchmark.running.run.run`.
    extractors
        By name; those installed by default.

    Raises
    ------
    StoreLockedError
        When a runner writes to the store.
    """
    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
    known = discover_extractors() if extractors is None else extractors
    components = components_of(known)
    with opened(Store(directory)) as record:
        swept = sweep_missing(record, components, known, workers=workers, progress=progress)
        record.write(components, ordered)
    return swept


def sweep_missing(
    record: Record,
    components: Components,
    extractors: Extractors,
    *,
    workers: int,
    progress: ProgressCallback | None = None,
) -> Swept:
    """Measure the points that a record does not hold of these components; drop unplanned ones.

    Parameters as `update`.
    """
    started = time.perf_counter()
    plan = planned(extractors)
    missing = [point for point in plan.settings if not record.is_swept(astuple(point), components)]
    wanted = {astuple(point) for point in (*plan.settings, *plan.refused)}
    record.drop(swept=lambda point: point in wanted)
    refused = [
        refused_row(point, extractors[point.extractor], reason)
        for point, reason in plan.refused.items()
    ]
    record.keep(
        components,
        swept=[
            row
            for row in refused
            if not record.is_swept(point_of(row), components)
            or record.swept[point_of(row)]["reason"] != row["reason"]
        ],
    )
    with terminal_progress() if progress is None else nullcontext(progress) as report:
        report(0, len(missing), "")
        done = 0
        for found in _outcomes(_bundles(missing, plan, extractors), workers):
            record.keep(components, swept=found)
            done += len(found)
            report(done, len(missing), f"{found[0]['series']} {found[0]['sweep']}")
    failed = [
        (point, record.swept[astuple(point)]["reason"])
        for point in plan.settings
        if record.swept[astuple(point)]["status"] == "failed"
    ]
    return Swept(
        len(plan.settings), len(missing), tuple(sorted(failed)), time.perf_counter() - started
    )


def unplanned(rows: Iterable[Row], extractors: Extractors) -> Iterator[tuple[Point, str]]:
    """Yield points that should be stored and are not, and the other way round, with which."""
    plan = planned(extractors)
    wanted = {*plan.settings, *plan.refused}
    there = {Point(*point_of(row)) for row in rows}
    for point in sorted(wanted ^ there):
        yield point, "absent" if point in wanted else "not planned"


def differences(committed: Sequence[Row], measured: Sequence[Row]) -> Iterator[tuple[str, ...]]:
    """Yield (point/column, committed, measured) where numbers differ by more than the tolerance."""
    there = {point_of(row): row for row in committed}
    for row in measured:
        point = point_of(row)
        known = there.get(point)
        if known is None:
            yield f"{'/'.join(point)}/row", "absent", "measured"
            continue
        for column, value in row.items():
            if not _close(column, known.get(column), value, row):
                yield f"{'/'.join(point)}/{column}", str(known.get(column)), str(value)


def ordered(rows: Iterable[Row]) -> list[Row]:
    """Order rows by series, sweep and point as they are defined, then by extractor."""
    series, sweeps = [*SERIES, ""], [*SWEEPS, ""]

    def place(row: Row) -> tuple[Any, ...]:
        value = row["value"]
        name = row["series"]
        return (
            series.index(name) if name in series else len(series),
            sweeps.index(row["sweep"]) if row["sweep"] in sweeps else len(sweeps),
            math.inf if value is None else value,
            *point_of(row),
        )

    return sorted(rows, key=place)


def _close(column: str, one: Any, other: Any, row: Row) -> bool:
    if column not in SWEPT or one is None or other is None or one == other:
        return bool(one == other)
    if column.endswith("_fraction"):
        allowed = _SAMPLES_TOLERANCE / row["n"]
    elif column == "bias":  # a mean near zero is as uncertain as the spread it averages
        allowed = RELATIVE_TOLERANCE * (row["rms"] or 0.0)
    else:
        allowed = RELATIVE_TOLERANCE * abs(other)
    return math.isclose(one, other, rel_tol=0.0, abs_tol=allowed)


Work = list[tuple[Point, Setting, type[Extractor]]]


def _bundles(missing: Sequence[Point], plan: Planned, extractors: Extractors) -> list[Work]:
    """Group points that share observations."""
    return [
        [(point, plan.settings[point], extractors[point.extractor]) for point in group]
        for _, group in groupby(sorted(missing), key=lambda p: (p.series, p.sweep, p.point))
    ]


def _outcomes(bundles: Sequence[Work], workers: int) -> Iterator[list[Row]]:
    with closing(as_completed(measure, bundles, workers if len(bundles) > 1 else 1)) as found:
        yield from found
