"""Is the committed leaderboard what its code and data give? Every difference named by its cell.

First what needs no measuring: the derived files follow from the stored scores, and the stored
scores are those of the code and data as they are. Then every cell is measured again from nothing.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from benchmark import data_pins, runner, sweeps
from benchmark.content_key import Specifications
from benchmark.leaderboard_formats import FORMATS, Cells
from benchmark.plan import cells
from benchmark.plan_parts import SPLITS, Parts
from benchmark.runner_progress import ProgressCallback
from benchmark.scoring import METRICS
from benchmark.store import PUBLISHED, Row, Store, cell_of

#: On the pinned environment scores are identical. Elsewhere another sine or another order of a sum
#: changes last bits of the light, which flips single digits of a converter here and there: single
#: samples of hundreds move by less than their noise, so statistics move by far less than this.
RELATIVE_TOLERANCE = 1e-3
#: A count may differ by one sample at the edge of being found.
_SAMPLES_TOLERANCE = 1.5

_DERIVED = ("rank", "row")


@dataclass(frozen=True, order=True)
class Difference:
    """One place where a committed file is not what it should be.

    Attributes
    ----------
    file
        Name of the file.
    cell
        ``dataset/condition/extractor/model/column``, or a line where there is no cell.
    committed
        What stands there.
    measured
        What should: regenerated, or measured again.
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
    """Compare committed results with what they follow from; an empty list is a pass.

    Parameters
    ----------
    directory
        The published files.
    workers, progress
        As `benchmark.runner.run`.
    stored_only
        Leave out measuring again: only whether the files agree with each other and with the code.
    parts
        Datasets and implementations; what is installed by default.

    Raises
    ------
    StoreError
        When a stored line cannot be read.
    """
    store = Store(directory)
    specifications = Specifications()
    found = [*_derived(store), *_outdated(store, parts, specifications)]
    if not stored_only:
        with tempfile.TemporaryDirectory() as temporary:
            fresh = Store(temporary)
            runner.run(
                cells(parts=parts),
                fresh,
                workers,
                progress,
                parts=parts,
                specifications=specifications,
            )
            found += compare(store.rows(), fresh.rows())
            sweeps.update(temporary, workers, progress, extractors=_extractors(parts))
            found += [
                Difference(sweeps.FILE, *difference)
                for difference in sweeps.differences(
                    sweeps.read(store.directory), sweeps.read(temporary)
                )
            ]
    return list(dict.fromkeys(found))


def compare(committed: list[Row], measured: list[Row]) -> list[Difference]:
    """Compare accuracy within the tolerance, everything else that is no time or hash exactly."""
    there = {str(cell_of(row)): row for row in committed}
    found = []
    for row in measured:
        cell = str(cell_of(row))
        known = there.get(cell)
        if known is None:
            found.append(Difference("scores.jsonl", f"{cell}/row", "absent", "measured"))
            continue
        for column, value in row.items():
            if column in ("key", "data_hash") or _close(column, known, row):
                continue
            found.append(
                Difference("scores.jsonl", f"{cell}/{column}", str(known.get(column)), str(value))
            )
    return found


def _close(column: str, committed: Row, measured: Row) -> bool:
    one, other = committed.get(column), measured[column]
    if column not in METRICS or one is None or other is None or one == other:
        return bool(one == other)
    try:
        one, other = float(one), float(other)
    except (TypeError, ValueError):
        return False
    if column.endswith("_fraction"):
        allowed = _SAMPLES_TOLERANCE / measured["n_test"]
    elif column.startswith("bias_"):  # a mean near zero is as uncertain as the spread it averages
        allowed = RELATIVE_TOLERANCE * (measured["rms_deg"] or 0.0)
    else:
        allowed = RELATIVE_TOLERANCE * abs(other)
    return math.isclose(one, other, rel_tol=0.0, abs_tol=allowed)


def _outdated(
    store: Store, parts: Parts | None, specifications: Specifications
) -> Iterator[Difference]:
    """Find stored scores that are of other code or data than there is, too few or too many."""
    planned = cells(parts=parts)
    rows = {cell_of(row): row for row in store.rows()}
    for cell in runner.stale(planned, store, parts=parts, specifications=specifications):
        row = rows.get(cell)
        if row is None:
            yield Difference("scores.jsonl", f"{cell}/row", "absent", "planned")
        elif row["status"] != "failed":
            yield Difference(
                "scores.jsonl", f"{cell}/key", row["key"], "another: code or data have changed"
            )
    for cell in sorted(rows.keys() - set(planned)):
        yield Difference("scores.jsonl", f"{cell}/row", "present", "not planned")
    yield from _unpinned(store, parts, specifications)
    for point, state in sweeps.outdated(store.directory, _extractors(parts)):
        yield Difference(sweeps.FILE, f"{point}/row", state, "as the code now is")


def _extractors(parts: Parts | None) -> sweeps.Extractors | None:
    return parts.extractors if parts else None


def _unpinned(
    store: Store, parts: Parts | None, specifications: Specifications
) -> Iterator[Difference]:
    """Find data that are not pinned for the code as it is, and pins of nothing."""
    pins = store.pins()
    for dataset, condition in data_pins.outdated(store, parts=parts, specifications=specifications):
        place = f"{dataset}/{condition}"
        if all((dataset, condition, split) in pins for split in SPLITS):
            changed = "another: code or parameters have changed"
            yield Difference("data.jsonl", f"{place}/specification", "as it was", changed)
        else:
            yield Difference("data.jsonl", f"{place}/pin", "absent", "pinned")
    for nothing in sorted(pins.keys() - data_pins.places(parts)):
        yield Difference("data.jsonl", f"{'/'.join(nothing)}/pin", "present", "no such data")


def _derived(store: Store) -> Iterator[Difference]:
    from benchmark.leaderboard import files  # noqa: PLC0415 - it offers `check` to its callers

    by_file: dict[str, dict[tuple[str, str], tuple[str, str]]] = {}
    for name, expected in files(store).items():
        path = store.directory / name
        if not path.is_file():
            yield Difference(name, "file", "absent", "written by `sunatlas leaderboard`")
            continue
        text = path.read_bytes().decode("utf-8", errors="replace")
        if text == expected:
            continue
        try:
            changed = _changed(FORMATS[name].read(text), FORMATS[name].read(expected))
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            yield Difference(name, "file", f"unreadable ({error})", "a leaderboard")
            continue
        by_file[name] = changed
        if not changed:
            yield _changed_line(name, text, expected)
    yield from _blamed(by_file)


def _changed(committed: Cells, expected: Cells) -> dict[tuple[str, str], tuple[str, str]]:
    here, should = {cell for cell, _ in committed}, {cell for cell, _ in expected}
    found = {(cell, "row"): ("present", "absent") for cell in here - should}
    found |= {(cell, "row"): ("absent", "present") for cell in should - here}
    for place in sorted(committed.keys() | expected.keys()):
        one, other = committed.get(place, "absent"), expected.get(place, "absent")
        if place[0] in here & should and one != other:
            found[place] = (one, other)
    return found


def _blamed(
    by_file: Mapping[str, Mapping[tuple[str, str], tuple[str, str]]],
) -> Iterator[Difference]:
    """Name the file a number was changed in.

    Where JSON and CSV agree with each other and not with the results they are derived from, it is
    the results that were changed.
    """
    swept = by_file.get("sweeps.csv", {})
    as_json, as_csv = by_file.get("leaderboard.json", {}), by_file.get("leaderboard.csv", {})
    as_csv = {**as_csv, **swept}
    agreed = {
        place: change
        for place, change in as_json.items()
        if as_csv.get(place) == change and place[1] not in _DERIVED
    }
    for (cell, column), (derived, stored) in agreed.items():
        source = "runs.jsonl" if column == "time_ratio" else "scores.jsonl"
        source = sweeps.FILE if (cell, column) in swept else source
        yield Difference(source, f"{cell}/{column}", stored, derived)
    conditions = {cell.rsplit("/", 2)[0] for cell, _ in agreed}
    for name, changes in by_file.items():
        for (cell, column), (committed, expected) in changes.items():
            follows = column == "rank" and cell.rsplit("/", 2)[0] in conditions
            if (cell, column) not in agreed and not follows:
                yield Difference(name, f"{cell}/{column}", committed, expected)


def _changed_line(name: str, text: str, expected: str) -> Difference:
    here, should = text.splitlines(), expected.splitlines()
    for number, (one, other) in enumerate(zip(here, should, strict=False), start=1):
        if one != other:
            return Difference(name, f"line {number}", one, other)
    return Difference(name, "file", f"{len(here)} lines", f"{len(should)} lines")
