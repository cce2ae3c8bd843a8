"""A search for cells whose published digits hang on rounding.

Sums in another order, as another processor or library makes them, have other last bits. Each cell
is measured as it is and with inputs that differ by some hundred times as much. A number that lies
between two digits turns its last one by one unit then; nothing may move by more.
`python -m benchmark.suites.perturbation DATASET...` searches under all conditions of data sets.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from itertools import groupby
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import Extractor, Floats
from algorithms.threads import one_thread
from benchmark.contract import Cell, Samples, UnknownNameError
from benchmark.plan.combinations import cells as planned
from benchmark.plan.parts import Parts, installed_parts
from benchmark.processes import call_to_end
from benchmark.progress import ProgressCallback, console_progress, silent
from benchmark.results.store import Store
from benchmark.running.condition_data import generate
from benchmark.running.fitting import data_condition
from benchmark.running.judging import Outcome
from benchmark.running.readings import found_features
from benchmark.running.stages import ConditionData, Task
from benchmark.running.task import measured_on
from benchmark.seeds import generator

#: A value's bits mixed until they are as good as random (SplitMix64's last step): no draw a value,
#: so that equal ones move alike and frames are as quick as noise.
_MIXES = ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB))

#: Relative standard deviation of what is added: some hundred times a rounding.
SIZE = 1e-13


@dataclass(frozen=True)
class SensitiveCell:
    """A cell whose numbers another rounding changes.

    Attributes
    ----------
    cell
        Which.
    inputs
        What was perturbed: ``"features"`` (and the calibration's directions) or
        ``"observations"``.
    columns
        Stored columns that differ, each with its value as it is and as perturbed; ``reason`` where
        one of the two is refused.
    """

    cell: Cell
    inputs: str
    columns: dict[str, tuple[Any, Any]]

    @property
    def is_moved(self) -> bool:
        """Whether a column differs by more than one unit of its last digit."""
        return not all(_neighbours(*both) for both in self.columns.values())

    def __str__(self) -> str:
        name = (
            "rms_all_answers_deg"
            if "rms_all_answers_deg" in self.columns
            else next(iter(self.columns))
        )
        before, after = self.columns[name]
        return (
            f"{self.cell} ({self.inputs}): {name} {before} -> {after}, "
            f"{len(self.columns)} columns differ"
        )


def _neighbours(before: Any, after: Any) -> bool:
    """Whether two stored numbers are one unit of their last digit apart, or less."""
    if not (isinstance(before, float) and isinstance(after, float)):
        return False
    one, other = Decimal(repr(before)), Decimal(repr(after))
    ends = (one.as_tuple().exponent, other.as_tuple().exponent)
    return abs(one - other) <= Decimal(1).scaleb(min(int(end) for end in ends))


@dataclass(frozen=True)
class PerturbationResult:
    """What a search looked at, and what it found: what differs, and what of it moved."""

    cells: int
    sensitive_cells: tuple[SensitiveCell, ...]

    @property
    def moved_cells(self) -> tuple[SensitiveCell, ...]:
        """Those that differ by more than a last digit's unit."""
        return tuple(one for one in self.sensitive_cells if one.is_moved)


def search(
    cells: Iterable[Cell],
    parts: Parts,
    report: Callable[[SensitiveCell], object] = lambda _: None,
    progress: ProgressCallback = silent,
    *,
    observations: bool = True,
    draw: int = 0,
) -> PerturbationResult:
    """Measure cells as they are and perturbed; name those that differ in a stored digit.

    Parameters
    ----------
    cells
        Which; of one data set, condition, unit and extractor those share the extraction.
    parts
        Data sets and implementations.
    report
        Called with each finding at once.
    progress
        Called with cells done and in all.
    observations
        Whether to perturb what extractors read, too; it takes a second extraction.
    draw
        Number of the random draw; another one is another search.
    """
    count, found = 0, []
    order = sorted(set(cells), key=lambda cell: (*_extraction(cell), cell.model))
    with one_thread():
        for _, group in groupby(order, key=_extraction):
            board = list(group)
            progress(count, len(order), board[0].dataset)
            count += len(board)
            for finding in _of_one_extraction(board, parts, observations, draw):
                report(finding)
                found.append(finding)
    return PerturbationResult(count, tuple(found))


def perturb(values: ArrayLike, *names: str | int) -> Floats:
    """Return values with relative noise of `SIZE`; whole numbers, zeros and NaN stay as they are.

    A whole number is a count or a sum of counts, exact in any order. Equal values move alike: the
    same sums are rounded the same way.

    Parameters
    ----------
    values
        Of any shape.
    names
        Of the random stream.

    Examples
    --------
    >>> perturb([2.0, 0.5, np.nan], "test") == [2.0, 0.5, np.nan]
    array([ True, False, False])
    """
    given = np.ascontiguousarray(values, dtype=np.float64)
    bits = given.view(np.uint64) ^ generator("perturbation", *names).integers(
        2**63, dtype=np.uint64
    )
    for shift, factor in _MIXES:
        bits ^= bits >> np.uint64(shift)
        bits *= np.uint64(factor)
    bits ^= bits >> np.uint64(31)
    noise = (bits >> np.uint64(11)).astype(np.float64) * (math.sqrt(12.0) / 2.0**53)
    noise -= math.sqrt(3.0)
    return np.where(given == np.round(given), given, given * (1.0 + SIZE * noise))


class _Perturbing:
    """An extractor that reads its observations perturbed."""

    def __init__(self, extractor: Extractor, *names: str | int) -> None:
        self.about, self.features = extractor.about, extractor.features
        self._extractor, self._names = extractor, names

    def extract(self, observations: ArrayLike) -> Floats:
        """Features (N, F) of observations that differ by a rounding."""
        given = np.asarray(observations)
        if given.dtype.kind != "f":
            return self._extractor.extract(given)
        moved = perturb(given, *self._names).astype(given.dtype)
        return self._extractor.extract(moved)


def _extraction(cell: Cell) -> tuple[str, str, int, str]:
    """Name what cells of one extraction share."""
    return cell.dataset, cell.condition, cell.unit, cell.extractor


def _of_one_extraction(
    board: Sequence[Cell], parts: Parts, observations: bool, draw: int
) -> Iterator[SensitiveCell]:
    cell = board[0]
    preset, made = parts.preset(cell.dataset), parts.extractor(cell.extractor)
    models = tuple(parts.model(one.model) for one in board)
    task = Task(preset, cell.condition, made, models, cell.unit)
    condition = data_condition(preset, cell.condition)
    data = generate(preset, condition, cell.unit)
    extractor = made.for_sensor(preset.geometry_for(condition))
    names = (cell.dataset, cell.condition, cell.unit, cell.extractor, draw)
    features = {split: found_features(data, extractor, split) for split in data.splits}
    variants = {"features": _moved_features(data, features, *names)}
    if observations:
        moved = cast("Extractor", _Perturbing(extractor, *names))
        fresh = replace(data, features={})
        again = {split: found_features(fresh, moved, split) for split in data.splits}
        if any(not np.array_equal(again[s], features[s], equal_nan=True) for s in features):
            variants["observations"] = (data, again)
    for one, model in zip(board, models, strict=True):
        before = _store(measured_on(task, extractor, model, features, data))
        for inputs, (given, moved_features) in variants.items():
            after = _store(measured_on(task, extractor, model, moved_features, given))
            differ = {
                name: (before.get(name), after.get(name))
                for name in before | after
                if before.get(name) != after.get(name)
            }
            if differ:
                yield SensitiveCell(one, inputs, differ)


def _moved_features(
    data: ConditionData, features: dict[str, Floats], *names: str | int
) -> tuple[ConditionData, dict[str, Floats]]:
    """Perturb features of every split, and the directions that the calibration is given."""
    known = cast("Any", data.splits["calibration"])
    truth = perturb(known.truth, *names, "directions")
    truth /= np.linalg.norm(truth, axis=1, keepdims=True)
    report = cast("Samples", _Reported(known, truth))
    moved = {split: perturb(found, *names) for split, found in features.items()}
    return replace(data, splits={**data.splits, "calibration": report}), moved


@dataclass(frozen=True)
class _Reported:
    """Calibration samples with other directions: what fits read of them."""

    samples: Samples
    truth: Floats

    @property
    def context(self) -> Any:
        return self.samples.context


def _store(outcome: Outcome) -> dict[str, Any]:
    return {"reason": outcome.reason} if outcome.score is None else outcome.score.row()


def main(arguments: Sequence[str] | None = None) -> int:
    """Search the published cells of data sets; 1 where one moves by more than a last digit."""
    parser = argparse.ArgumentParser(prog="python -m benchmark.suites.perturbation")
    parser.add_argument("datasets", nargs="*", help="names; all by default")
    parser.add_argument("--condition", action="append", help="of the data sets; all by default")
    parser.add_argument("--extractor", action="append", help="all by default")
    parser.add_argument("--model", action="append", help="all by default")
    parser.add_argument("--draw", type=int, default=0, help="another number is another search")
    parser.add_argument(
        "--all", action="store_true", help="compatible cells, not only those of the record"
    )
    asked = parser.parse_args(arguments)
    parts = installed_parts()
    try:
        wanted = planned(
            asked.datasets or None, asked.condition, asked.extractor, asked.model, parts=parts
        )
    except UnknownNameError as error:
        parser.error(str(error))
    if not asked.all:
        known = {replace(cell, unit=0) for cell in Store().scores()}
        wanted = [cell for cell in wanted if cell in known]
    with console_progress("perturbing") as report:
        done = search(
            wanted, parts, lambda one: sys.stdout.write(f"{one}\n"), report, draw=asked.draw
        )
    turned = len(done.sensitive_cells) - len(done.moved_cells)
    sys.stdout.write(
        f"{done.cells} cells: {len(done.moved_cells)} move, {turned} turn a last digit\n"
    )
    return 1 if done.moved_cells else 0


if __name__ == "__main__":
    call_to_end(main)
