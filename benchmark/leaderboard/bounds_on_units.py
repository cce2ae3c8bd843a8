"""`python -m benchmark.leaderboard.bounds_on_units`: no score may lie below its bound.

Of every board and condition the pipeline that comes nearest to a bound is scored on units nobody
has seen. One unit may be luckier than a bound that is a mean over units, several may not: printed
is the root of the mean square of its errors on them, each over its own bound. Which is that of the
standard unit times what each unit, known, has of that one's: drifts of another unit are no spread.
"""

from __future__ import annotations

import argparse
import math
import statistics
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from benchmark.contract import ON_BENCH, Cell, UnknownNameError
from benchmark.leaderboard import scope
from benchmark.metrics.score import is_available
from benchmark.plan.parts import Parts, installed_parts
from benchmark.processes import call_to_end
from benchmark.results.csv_tables import Row
from benchmark.results.store import PUBLISHED, Store
from benchmark.running.runner import RunInterruptedError, run
from files.atomic import temporary_directory

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset

#: Bounds that stand beside a score: of a unit that is known, and of one that is not.
BOUNDS = ("bound_deg", "bound_unit_deg")
#: Times a bound up to which the nearest score is tried, and that counts as reaching it.
NEAR = 1.05
#: Standard errors below its bound that are chance.
BY_CHANCE = 2.0


@dataclass(frozen=True)
class RatioToBound:
    """Error of a pipeline over one of its bounds: on the standard unit, and on fresh ones."""

    cell: Cell
    bound: str
    standard: float
    units: int
    ratio: float
    standard_error: float

    @property
    def is_below(self) -> bool:
        """Whether the error on fresh units is below the bound by more than chance."""
        return self.ratio + BY_CHANCE * self.standard_error < 1.0


def nearest_to_bounds(scores: Mapping[Cell, Row], near: float = NEAR) -> dict[Cell, list[str]]:
    """Return by cell the bounds to which it comes nearest of its board and condition.

    Of the standard unit; where the nearest errs more than `near` times a bound, that is left out.
    """
    nearest: dict[tuple[str, str, str], tuple[float, Cell]] = {}
    for cell, row in scores.items():
        if cell.unit or cell.condition == ON_BENCH or not is_available(row):
            continue
        for bound in BOUNDS:
            if row["rms_deg"] and row[bound]:
                place, found = (cell.dataset, cell.condition, bound), row["rms_deg"] / row[bound]
                nearest[place] = min(nearest.get(place, (math.inf, cell)), (found, cell))
    chosen: dict[Cell, list[str]] = {}
    for (_, _, bound), (ratio, cell) in sorted(nearest.items()):
        if ratio <= near:
            chosen.setdefault(cell, []).append(bound)
    return chosen


def ratio_to_bound(
    cell: Cell, bound: str, standard: Row, errors_deg: Sequence[float]
) -> RatioToBound:
    """Compare errors of at least two units, as if each had the standard one's bound, with that.

    The standard error is that of a mean of squares, by the spread over the units.
    """
    squares = [(error / standard[bound]) ** 2 for error in errors_deg]
    ratio = math.sqrt(statistics.fmean(squares))
    spread = statistics.stdev(squares) / math.sqrt(len(squares))
    own = standard["rms_deg"] / standard[bound]
    return RatioToBound(cell, bound, own, len(squares), ratio, spread / (2.0 * ratio))


def try_bounds(
    store: Store, units: int, workers: int = 1, *, parts: Parts | None = None
) -> dict[Cell, list[RatioToBound]]:
    """Score what comes nearest to bounds on fresh units; nothing is written to the store.

    ValueError for fewer than two units, or answers of fewer: no standard error follows of them.
    """
    if units < 2:
        raise ValueError(f"expected at least 2 units, got {units}")
    known, scores = parts or installed_parts(), store.scores()
    of_parts = {cell: row for cell, row in scores.items() if cell.dataset in known.presets}
    chosen = nearest_to_bounds(of_parts)
    fresh = range(scope.UNITS, scope.UNITS + units)
    wanted = [replace(cell, unit=unit) for cell in chosen for unit in fresh]
    try:
        with temporary_directory() as temporary:
            measured = Store(temporary)
            run(wanted, measured, workers, parts=known)
            found = measured.scores()
    except KeyboardInterrupt as interrupted:
        raise RunInterruptedError("interrupted; nothing of it is kept") from interrupted
    shares = {
        place: _shares(known.presets[place[0]], place[1], fresh)
        for place in dict.fromkeys((cell.dataset, cell.condition) for cell in chosen)
    }
    ratios = {}
    for cell, bounds in chosen.items():
        rows = [found[replace(cell, unit=unit)] for unit in fresh]
        errors = [
            row["rms_deg"] / share
            for row, share in zip(rows, shares[cell.dataset, cell.condition], strict=True)
            if row["rms_deg"] is not None
        ]
        if len(errors) < 2:
            raise ValueError(f"{cell}: expected answers of 2 units or more, got {len(errors)}")
        ratios[cell] = [ratio_to_bound(cell, bound, scores[cell], errors) for bound in bounds]
    return ratios


def _shares(preset: Preset, condition: str, units: Iterable[int]) -> list[float]:
    """Return the bounds of single samples of units, each known, over that of the standard one."""

    def known(one: Preset) -> float:
        bound = getattr(one, "sample_bound", one.bound)(condition, "test")
        seen = np.asarray(bound.observable, dtype=np.bool_)
        return float(np.sqrt(np.mean(np.asarray(bound.angle_deg)[seen] ** 2)))

    standard = known(preset)
    return [known(preset.for_unit(unit)) / standard for unit in units]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line a bound; exit code 1 where a score lies below one by more than chance."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("boards", nargs="*", metavar="DATASET", help="only these; all by default")
    parser.add_argument("--units", type=int, default=30, help="fresh units; 30 by default")
    parser.add_argument("--workers", type=int, default=1, help="processes that measure")
    options = parser.parse_args(arguments)
    if options.units < 2:
        parser.error(f"--units: expected at least 2, got {options.units}")
    if options.workers < 1:
        parser.error(f"--workers: expected a positive number, got {options.workers}")
    known, found = installed_parts(), []
    try:
        presets = {name: known.preset(name) for name in options.boards or known.presets}
    except UnknownNameError as error:
        parser.error(str(error))
    for name, preset in presets.items():  # board by board: each takes minutes
        parts = replace(known, presets={name: preset})
        tried = try_bounds(Store(PUBLISHED), options.units, options.workers, parts=parts)
        for one in (ratio for ratios in tried.values() for ratio in ratios):
            found.append(one)
            sys.stdout.write(
                f"{one.cell}: {one.standard:.3f} of {one.bound}, on {one.units} fresh units "
                f"{one.ratio:.3f} +- {one.standard_error:.3f}{' BELOW' * one.is_below}\n"
            )
            sys.stdout.flush()
    below, reached = sum(one.is_below for one in found), sum(one.ratio <= NEAR for one in found)
    sys.stdout.write(
        f"{below} of {len(found)} are below their bound by more than {BY_CHANCE:g} standard "
        f"errors; {reached} are within {NEAR:g} of it\n"
    )
    return int(below > 0)


if __name__ == "__main__":
    call_to_end(main)
