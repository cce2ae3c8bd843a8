"""Is the committed record what its code and data give? Every difference named by its cell.

First what needs no measuring: the page follows from the record, and the record is of the code as
it is. Where code of datasets has changed their first samples are compared, and where those moved
under the same version that is the answer. Else everything is measured again from nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from benchmark.contract import Cell
from benchmark.experiments.sweeps import Sweeps
from benchmark.leaderboard import scope
from benchmark.leaderboard.board import board_of
from benchmark.leaderboard.pages import PAGE, page
from benchmark.leaderboard.update import update
from benchmark.metrics.rings import RINGS
from benchmark.metrics.score import METRICS, RING_DIGITS
from benchmark.metrics.separation import SIGNIFICANT_DIGITS
from benchmark.plan.parts import Parts, installed_parts
from benchmark.progress import ProgressCallback
from benchmark.results import record_manifest
from benchmark.results.components import current
from benchmark.results.csv_tables import Row
from benchmark.results.store import PUBLISHED, Store
from benchmark.running import pinning
from benchmark.running.experiment import RecordedExperiment, experiments, list_due
from benchmark.running.runner import RunInterruptedError
from benchmark.sweeps.differences import differences
from benchmark.sweeps.record import RECORD as SWEEPS
from benchmark.sweeps.record import swept
from files.atomic import temporary_directory
from survey_data import facts_manifest

#: On the pinned environment scores are identical. Elsewhere another order of a sum changes last
#: bits, which a fit may amplify a million times before it is refused.
RELATIVE_TOLERANCE = 1e-4
#: A share may differ by one sample at the edge of being found.
_SAMPLES_TOLERANCE = 1.5

_RING_COLUMNS = frozenset(ring.column for ring in RINGS)


@dataclass(frozen=True, order=True)
class Difference:
    """One place where the committed record is not what it should be.

    `cell` is ``dataset/condition/extractor/model/column`` and the like, `committed` what stands
    there, `measured` what should.
    """

    file: str
    cell: str
    committed: str
    measured: str

    def __str__(self) -> str:
        return f"{self.file}: {self.cell} is {self.committed}, should be {self.measured}"


def check(
    directory: Path | str = PUBLISHED,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    stored_only: bool = False,
    parts: Parts | None = None,
) -> list[Difference]:
    """Compare the committed record with what it follows from; an empty list is a pass.

    `stored_only` leaves out generating and measuring: only whether the files agree with each other,
    with the versions and sizes of the data sets and with the code as it is, and the page with them.
    `parts` are what is installed by default. StoreError, ComponentsError when a stored file cannot
    be read; RunInterruptedError on Ctrl-C, nothing is kept.
    """
    store = Store(directory)
    known = parts or installed_parts()
    wanted = scope.published_scope(store.scores(), known)
    found = [*differences_of_files(store, known, wanted), *_due(store, known), *_derive(store)]
    if stored_only:
        return found
    moved = list(_moved_heads(store, known))
    if moved:  # every number of these datasets is another: there is no point in measuring it
        return [*moved, *found]
    found += measured_again(store, partial(update, workers=workers, progress=progress, parts=parts))
    return list(dict.fromkeys(found))


def differences_of_files(
    store: Store, parts: Parts, wanted: Collection[Cell]
) -> Iterator[Difference]:
    """Find what shows without measuring: changes by hand, other code or cells."""
    yield from by_hand(store)
    yield from outdated(store, parts, wanted)


def measured_again(store: Store, measure: Callable[[Path], object]) -> list[Difference]:
    """Compare a record with the one that `measure` makes in an empty directory."""
    try:
        with temporary_directory() as temporary:
            measure(temporary)
            return compare(store, Store(temporary))
    except KeyboardInterrupt as interrupted:
        raise RunInterruptedError(
            "interrupted; a check keeps nothing of what it measured"
        ) from interrupted


def compare(committed: Store, measured: Store) -> list[Difference]:
    """Compare two records: accuracy within the tolerance, all else that is no digest exactly."""
    found = [
        *_moved_data(committed, measured),
        *compare_scores(committed.scores(), measured.scores(), _counts(measured)),
    ]
    for place, one, other in differences(swept(committed.directory), swept(measured.directory)):
        found.append(Difference(SWEEPS.name, place, one, other))
    return found


def compare_scores(
    committed: Mapping[Cell, Row],
    measured: Mapping[Cell, Row],
    samples: Mapping[tuple[str, str], int],
) -> list[Difference]:
    """Compare scores by cell; `samples` of the test split are what a share is of."""
    found = []
    for cell in sorted(committed.keys() | measured.keys()):
        file = f"scores/{cell.dataset}.csv"
        known, row = committed.get(cell), measured.get(cell)
        if known is None or row is None:
            states = ("absent", "measured") if known is None else ("present", "not measured")
            found.append(Difference(file, f"{cell}/row", *states))
            continue
        count = samples.get((cell.dataset, cell.condition), 1)
        for column, value in row.items():
            if not _close(column, known.get(column), value, row, count):
                pair = str(known.get(column)), str(value)
                found.append(Difference(file, f"{cell}/{column}", *pair))
    return found


def _close(column: str, one: Any, other: Any, measured: Row, samples: int) -> bool:
    if column not in METRICS or one is None or other is None or one == other:
        return bool(one == other)
    if column in ("availability", "false_detection_rate"):
        allowed = _SAMPLES_TOLERANCE / samples
    elif column.startswith("bias_"):  # a mean near zero is as uncertain as the spread it averages
        allowed = RELATIVE_TOLERANCE * (measured["rms_deg"] or 0.0)
    else:
        allowed = RELATIVE_TOLERANCE * abs(other)
    return bool(abs(one - other) <= max(allowed, 1.01 * _last_digit(column, other)))


def _last_digit(column: str, value: float) -> float:
    """Return the step between neighbours of a number as it is stored."""
    digits = RING_DIGITS if column in _RING_COLUMNS else SIGNIFICANT_DIGITS
    return float(10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)) if value else 0.0


def _counts(store: Store) -> dict[tuple[str, str], int]:
    return {place[:2]: pin.n for place, pin in store.pins().items() if place[2] == "test"}


def by_hand(store: Store) -> Iterator[Difference]:
    """Name what no command wrote so, in the record and, for the published one, in the facts."""
    published = store.directory == PUBLISHED
    problems = record_manifest.changes(store.directory, required=published)
    for problem in [*problems, *(facts_manifest.changes() if published else ())]:
        should = f"as `{record_manifest.COMMAND}` has it"
        yield Difference(problem.file, "file", problem.message, should)


def _moved_heads(store: Store, parts: Parts) -> Iterator[Difference]:
    """Find datasets whose first samples are not as pinned, in seconds."""
    components = current(parts)
    changed = pinning.presets_of_other_code(store, parts, components)
    for name, lines in pinning.changed_heads(store.pins(), changed).items():
        for line in lines:
            yield Difference(
                store.pins_path.name,
                f"{name}/{'/'.join(line.partition(':')[0].split())}",
                f"version {parts.presets[name].version}",
                f"{line.partition(': ')[2]}: the data changed and the version did not",
            )


def _moved_data(committed: Store, measured: Store) -> Iterator[Difference]:
    """Find data and bounds that are not as pinned, each named by its dataset."""
    pinned, made = committed.pins(), measured.pins()
    file = committed.pins_path.name
    for place in sorted(pinned.keys() | made.keys()):
        one, other = pinned.get(place), made.get(place)
        cell = "/".join(place)
        if one is None or other is None:
            states = ("absent", "pinned") if one is None else ("present", "no such data")
            yield Difference(file, cell, *states)
        elif one.version != other.version:
            pair = f"version {one.version}", f"version {other.version}"
            yield Difference(file, cell, *pair)
        elif said := one.difference(other):
            pair = f"version {one.version}", f"{said}: the data changed and the version did not"
            yield Difference(file, cell, *pair)


def outdated(store: Store, parts: Parts, wanted: Collection[Cell]) -> Iterator[Difference]:
    """Find components of other code than there is, and what is stored too much or too little."""
    stored = store.components()
    now = current(parts)
    for name, one, other in stored.differences(now):
        if one or _is_used(name, store):
            yield Difference(
                store.components_path.name,
                name,
                one or "absent",
                "another: code or parameters have changed" if other else "not installed",
            )
    scores = store.scores()
    yield from _unlike("scores", {str(c) for c in scores}, {str(c) for c in wanted}, "planned")
    pinned = {"/".join(place) for place in store.pins()}
    there = {"/".join(place) for place in pinning.places(parts)}
    yield from _unlike(store.pins_path.name, pinned, there, "pinned")


def _due(store: Store, parts: Parts) -> Iterator[Difference]:
    """Find the cells of recorded experiments that are to be measured again."""
    for name, kind in experiments().items():
        if issubclass(kind, RecordedExperiment) and _is_of(kind, store):
            should = f"renewed by `python -m benchmark.experiments {name}`"
            for cell, why in list_due(kind(store.directory, parts)):
                yield Difference(kind.record.name, str(cell), why, should)


def _is_of(kind: type[RecordedExperiment[Any]], store: Store) -> bool:
    """Say whether a record has an experiment; others than the published one need only sweeps."""
    wanted = store.directory == PUBLISHED or kind is Sweeps
    return wanted or (store.directory / kind.record.name).is_file()


def _is_used(name: str, store: Store) -> bool:
    """Say whether a component that is not stored should be; one that nothing reads need not."""
    return not store.components_path.is_file() or name.startswith("stages/")


def _unlike(
    file: str, stored: Iterable[str], wanted: Iterable[str], word: str
) -> Iterator[Difference]:
    here, there = set(stored), set(wanted)
    for name in sorted(here ^ there):
        pair = ("absent", word) if name in there else ("present", f"not {word}")
        yield Difference(file, f"{name}/row", *pair)


def _derive(store: Store) -> Iterator[Difference]:
    path = store.directory / PAGE
    text = path.read_bytes().decode("utf-8", errors="replace") if path.is_file() else ""
    expected = page(board_of(store))
    if not text:
        yield Difference(PAGE, "file", "absent", "written by `sunatlas leaderboard update`")
        return
    here, should = text.splitlines(), expected.splitlines()
    for number, (one, other) in enumerate(zip(here, should, strict=False), start=1):
        if one != other:
            yield Difference(PAGE, f"line {number}", one, other)
            return
    if text != expected:
        yield Difference(PAGE, "file", f"{len(here)} lines", f"{len(should)} lines")
