"""Sweeps over noise, feature size, sub-pixel phase and more: error of every method, and its bound.

Rows live in ``sweeps.jsonl`` beside the scores: canonical JSON, one row a line, sorted. Like
scores they depend on code only, never on time, machine or number of workers; a row whose key is
that of the code as it is stays, so that bringing them up to date measures what has changed.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from joblib import Parallel, delayed, parallel_config

from algorithms.contract import Extractor
from algorithms.discovery import discover_extractors
from benchmark.content_key import canonical_json
from benchmark.reference_series import SWEEPS, Setting
from benchmark.runner_progress import ProgressCallback, terminal_progress
from benchmark.store import PUBLISHED, Store, StoreError, replace
from benchmark.store_journal import locked
from benchmark.sweep_measure import METRICS, SWEEP_VERSION, key_of, measure, refused_row
from benchmark.sweep_plan import SERIES, Planned, Point, planned

Row = dict[str, Any]
Extractors = Mapping[str, type[Extractor]]

FILE = "sweeps.jsonl"
#: As `benchmark.leaderboard_check.RELATIVE_TOLERANCE`, and of samples at the edge of being found.
RELATIVE_TOLERANCE = 1e-3
_SAMPLES_TOLERANCE = 1.5

_IDENTITY = ("series", "sweep", "point", "extractor")


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


def read(directory: Path | str = PUBLISHED) -> list[Row]:
    """Return the stored rows in order; none where there is no file.

    Raises
    ------
    StoreError
        For a line that is no row, one that is there twice, or another version's.
    """
    path = Path(directory) / FILE
    if not path.is_file():
        return []
    rows: dict[Point, Row] = {}
    for number, line in enumerate(path.read_bytes().splitlines(), start=1):
        where = f"{path}, line {number}"
        try:
            row = json.loads(line)
        except ValueError as error:
            raise StoreError(f"{where}: not JSON ({error})") from error
        if not isinstance(row, dict) or not all(
            isinstance(row.get(name), str) for name in (*_IDENTITY, "key", "status")
        ):
            raise StoreError(f"{where}: not a row of a sweep")
        if row.get("sweep_version") != SWEEP_VERSION:
            raise StoreError(
                f"{where}: written under version {row.get('sweep_version')!r}, this one reads "
                f"{SWEEP_VERSION}; delete the file and run `sunatlas leaderboard`"
            )
        point = point_of(row)
        if point in rows:
            raise StoreError(f"{where}: {point} is there twice")
        rows[point] = row
    return _sorted(rows.values())


def update(
    directory: Path | str = PUBLISHED,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    extractors: Extractors | None = None,
) -> Swept:
    """Measure what is missing or out of date, drop what is no longer planned, write the file.

    Parameters
    ----------
    directory
        Where the file is.
    workers
        Number of processes; the rows do not depend on it.
    progress
        As `benchmark.runner.run`.
    extractors
        By name; those installed by default.

    Raises
    ------
    StoreLockedError
        When a runner writes to the store.
    """
    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
    started = time.perf_counter()
    known = discover_extractors() if extractors is None else extractors
    plan = planned(known)
    store = Store(directory)
    with locked(store):
        held = {point_of(row): row for row in read(store.directory)}
        missing = [point for point in plan.settings if not _is_current(point, held, plan, known)]
        rows = {
            point: refused_row(point, known[point.extractor], reason)
            for point, reason in plan.refused.items()
        }
        rows |= {p: held[p] for p in plan.settings.keys() - set(missing)}
        try:
            with terminal_progress() if progress is None else nullcontext(progress) as report:
                report(0, len(missing), "")
                done = 0
                for found in _outcomes(_bundles(missing, plan, known), workers):
                    rows |= {point_of(row): row for row in found}
                    done += len(found)
                    report(done, len(missing), f"{found[0]['series']} {found[0]['sweep']}")
        finally:  # also on Ctrl-C: what is measured is kept
            text = "".join(canonical_json(row) + "\n" for row in _sorted(rows.values()))
            replace(store.directory / FILE, text)
    failed = tuple((p, row["reason"]) for p, row in rows.items() if row["status"] == "failed")
    return Swept(
        len(plan.settings), len(missing), tuple(sorted(failed)), time.perf_counter() - started
    )


def outdated(
    directory: Path | str = PUBLISHED, extractors: Extractors | None = None
) -> list[tuple[Point, str]]:
    """List points not stored as the code now is, each with what it is instead; measures nothing."""
    known = discover_extractors() if extractors is None else extractors
    plan = planned(known)
    held = {point_of(row): row for row in read(directory)}
    found = []
    for point in (*plan.settings, *plan.refused):
        if point not in held:
            found.append((point, "absent"))
        elif held[point]["key"] != _key(point, plan, known):
            found.append((point, "of other code"))
    found += [(p, "not planned") for p in held if p not in plan.settings and p not in plan.refused]
    return sorted(found)


def differences(committed: Sequence[Row], measured: Sequence[Row]) -> Iterator[tuple[str, ...]]:
    """Yield (point/column, committed, measured) where numbers differ by more than the tolerance."""
    there = {point_of(row): row for row in committed}
    for row in measured:
        point = point_of(row)
        known = there.get(point)
        if known is None:
            yield f"{point}/row", "absent", "measured"
            continue
        for column, value in row.items():
            if column != "key" and not _close(column, known.get(column), value, row):
                yield f"{point}/{column}", str(known.get(column)), str(value)


def point_of(row: Mapping[str, Any]) -> Point:
    """Return the point a row is of."""
    return Point(*(row[name] for name in _IDENTITY))


def _close(column: str, one: Any, other: Any, row: Row) -> bool:
    if column not in METRICS or one is None or other is None or one == other:
        return bool(one == other)
    if column.endswith("_fraction"):
        allowed = _SAMPLES_TOLERANCE / row["n"]
    elif column == "bias":  # a mean near zero is as uncertain as the spread it averages
        allowed = RELATIVE_TOLERANCE * (row["rms"] or 0.0)
    else:
        allowed = RELATIVE_TOLERANCE * abs(other)
    return math.isclose(one, other, rel_tol=0.0, abs_tol=allowed)


def _key(point: Point, plan: Planned, known: Extractors) -> str:
    reason = plan.refused.get(point, "")
    return key_of(point, plan.settings.get(point), known[point.extractor], reason)


def _is_current(point: Point, held: Mapping[Point, Row], plan: Planned, known: Extractors) -> bool:
    row = held.get(point)
    return row is not None and row["status"] != "failed" and row["key"] == _key(point, plan, known)


Work = list[tuple[Point, Setting, type[Extractor]]]


def _bundles(missing: Sequence[Point], plan: Planned, known: Extractors) -> list[Work]:
    """Group points that share observations."""
    return [
        [(point, plan.settings[point], known[point.extractor]) for point in group]
        for _, group in groupby(sorted(missing), key=lambda p: (p.series, p.sweep, p.point))
    ]


def _outcomes(bundles: Sequence[Work], workers: int) -> Iterator[list[Row]]:
    if workers == 1 or len(bundles) < 2:
        yield from map(measure, bundles)
        return
    with parallel_config("loky", n_jobs=workers, inner_max_num_threads=1):
        parallel = Parallel(return_as="generator_unordered", batch_size=1)
        yield from parallel(delayed(measure)(bundle) for bundle in bundles)


def _sorted(rows: Any) -> list[Row]:
    """Order rows by series, sweep and point as they are defined, then by extractor."""
    series, sweeps = [*SERIES, ""], [*SWEEPS, ""]

    def place(row: Row) -> tuple[Any, ...]:
        value = row["value"]
        name = row["series"]
        return (
            series.index(name) if name in series else len(series),
            sweeps.index(row["sweep"]) if row["sweep"] in sweeps else len(sweeps),
            math.inf if value is None else value,
            *(row[name] for name in _IDENTITY),
        )

    return sorted(rows, key=place)
