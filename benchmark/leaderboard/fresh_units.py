"""`python -m benchmark.leaderboard.fresh_units`: leaders of boards on units nobody has seen.

The first group of every board, its leader and what is not distinguished from it, is scored on five
more units, and so are the next five pipelines behind it. Printed is for each board whether its
leader is in the first group of these there, too, and how much more it errs than the first.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from benchmark.contract import Cell
from benchmark.leaderboard import scope
from benchmark.metrics import paired
from benchmark.metrics.score import is_available
from benchmark.plan.parts import Parts, installed_parts
from benchmark.processes import call_to_end
from benchmark.results.csv_tables import Row
from benchmark.results.store import PUBLISHED, Store
from benchmark.running.runner import RunInterruptedError, run
from files.atomic import temporary_directory

#: Units that no board is made of.
FRESH = range(scope.UNITS, scope.UNITS + 5)
#: Pipelines behind the first group that are scored beside it: a leader alone would always lead.
BEHIND = 5


@dataclass(frozen=True)
class FreshUnitResult:
    """How the first group of one board did on fresh units.

    How many pipelines are on the board and in its first group; its leader, chosen on the board's
    own units; whether that is in the first group on the fresh ones by the same test, and the
    geometric mean there of its errors over those of the first there.
    """

    dataset: str
    pipelines: int
    first: int
    leader: Cell
    holds: bool
    over: float


def first_groups(
    scores: Mapping[Cell, Row], parts: Parts
) -> dict[str, tuple[list[Cell], list[Cell]]]:
    """Return the first group of each board, its leader first, and the next pipelines behind it.

    Cells are of the standard unit.
    """
    found = {}
    ranked = (cell for cell in scope.first(parts) if _ranks(scores.get(cell)))
    for dataset, group in groupby(ranked, key=lambda cell: cell.dataset):
        board = list(group)
        logs = _logs(board, scores, range(scope.UNITS))
        leader = paired.best_method(logs)
        groups, means = paired.groups(logs, leader), np.nanmean(logs, axis=1)
        order = sorted(range(len(board)), key=lambda at: float(means[at]))
        first = [board[at] for at in order if groups[at] == 1 and at != leader]
        behind = [board[at] for at in order if groups[at] != 1]
        found[dataset] = [board[leader], *first], behind[:BEHIND]
    return found


def score_fresh_units(
    store: Store, workers: int = 1, *, parts: Parts | None = None
) -> list[FreshUnitResult]:
    """Score the first of every board on the fresh units; nothing is written to the store."""
    known = parts or installed_parts()
    scores = store.scores()
    groups = first_groups(scores, known)
    boards = {dataset: [*first, *behind] for dataset, (first, behind) in groups.items()}
    wanted = [replace(c, unit=unit) for cells in boards.values() for c in cells for unit in FRESH]
    try:
        with temporary_directory() as temporary:
            fresh = Store(temporary)
            run(wanted, fresh, workers, parts=known)
            measured = fresh.scores()
    except KeyboardInterrupt as interrupted:
        raise RunInterruptedError("interrupted; nothing of it is kept") from interrupted
    found = []
    for dataset, cells in boards.items():
        logs = _logs(cells, measured, FRESH)
        best = paired.best_method(logs)
        holds = not paired.separate(logs, best)[0]
        over = float(paired.over(logs, best)[0])
        pipelines = sum(cell.dataset == dataset for cell in scope.first(known))
        first = len(groups[dataset][0])
        found.append(FreshUnitResult(dataset, pipelines, first, cells[0], holds, over))
    return found


def _ranks(row: Row | None) -> bool:
    return row is not None and row["rms_all_answers_deg"] is not None and is_available(row)


def _logs(cells: Sequence[Cell], scores: Mapping[Cell, Row], units: Iterable[int]) -> np.ndarray:
    errors = [
        [
            scores.get(replace(cell, unit=unit), {"rms_all_answers_deg": None})[
                "rms_all_answers_deg"
            ]
            for unit in units
        ]
        for cell in cells
    ]
    return paired.logarithms(errors)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line a board; exit code 1 where fewer than 38 of 40 leaders hold."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--workers", type=int, default=1, help="processes that measure")
    workers = parser.parse_args(arguments).workers
    if workers < 1:
        parser.error(f"--workers: expected a positive number, got {workers}")
    found = score_fresh_units(Store(PUBLISHED), workers)
    for one in found:
        sys.stdout.write(
            f"{one.dataset}: {one.first} of {one.pipelines} in the first group; "
            f"{one.leader.extractor} + {one.leader.model} "
            f"{'holds' if one.holds else 'is behind'} on fresh units, {one.over:.3f} of the first\n"
        )
    holds = sum(one.holds for one in found)
    small = sum(one.first < 0.1 * one.pipelines for one in found)
    sys.stdout.write(
        f"{holds} of {len(found)} leaders are in the first group on units {FRESH[0]} to "
        f"{FRESH[-1]}; on {small} boards the first group has fewer than 10 % of the pipelines\n"
    )
    return 0 if holds >= 0.95 * len(found) else 1


if __name__ == "__main__":
    call_to_end(main)
