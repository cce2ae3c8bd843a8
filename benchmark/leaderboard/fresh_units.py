"""`python -m benchmark.leaderboard.fresh_units`: leaders of boards on units nobody has seen.

The first group of every board, its leader and what is not distinguished from it, is scored on five
more units, and so are the next five pipelines behind it. Printed is for each board whether its
leader is in the first group of these there, too, and how much more it errs than the first. With
`--flight` the boards are those in flight (of data sets in orbit the first condition). Each `--seed`
draws five units of its own, and Suns, light, Earth and missions with them.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from benchmark.contract import FLIGHT, Cell, UnknownNameError
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
#: Times the error of the best up to which a first group is still first.
NEAR = 1.1


@dataclass(frozen=True)
class FreshUnitResult:
    """How the first group of one board did on fresh units.

    How many pipelines are on the board and in its first group; its leader, chosen on the board's
    own units; whether that is in the first group on the fresh ones by the same test, and the
    geometric mean there of its errors over those of the first there, and of the best's of the
    first group.
    """

    dataset: str
    pipelines: int
    first: int
    leader: Cell
    holds: bool
    over: float
    group_over: float


def first_groups(
    scores: Mapping[Cell, Row], parts: Parts, *, in_flight: bool = False
) -> dict[str, tuple[list[Cell], list[Cell]]]:
    """Return the first group of each board, its leader first, and the next pipelines behind it.

    Cells are of the standard unit. What was measured on that alone is ordered by its error times
    what units err over the standard one (`benchmark.metrics.ranking.luck_of_standard`).
    """
    found = {}
    cells = (_of_level(cell, parts, in_flight=in_flight) for cell in scope.first(parts))
    ranked = (cell for cell in cells if _ranks(scores.get(cell)))
    for dataset, group in groupby(ranked, key=lambda cell: cell.dataset):
        board = list(group)
        logs = _logs(board, scores, range(scope.UNITS))
        leader = paired.best_method(logs)
        groups, means = paired.groups(logs, leader), np.nanmean(logs, axis=1)
        alone = np.isfinite(logs).sum(axis=1) == 1
        means[alone] += np.median(means[~alone] - logs[~alone, 0]) if not alone.all() else 0.0
        order = sorted(range(len(board)), key=lambda at: float(means[at]))
        first = [board[at] for at in order if groups[at] == 1 and at != leader]
        behind = [board[at] for at in order if groups[at] != 1]
        found[dataset] = [board[leader], *first], behind[:BEHIND]
    return found


def score_fresh_units(
    store: Store,
    workers: int = 1,
    *,
    parts: Parts | None = None,
    in_flight: bool = False,
    seeds: Sequence[int] = (),
) -> list[FreshUnitResult]:
    """Score the first of every board on the fresh units; nothing is written to the store.

    On five units that see what the boards saw, or for each seed on five with all drawn by it.
    """
    known = parts or installed_parts()
    scores = store.scores()
    groups = first_groups(scores, known, in_flight=in_flight)
    boards = {dataset: [*first, *behind] for dataset, (first, behind) in groups.items()}
    wanted = [replace(c, unit=unit) for cells in boards.values() for c in cells for unit in FRESH]
    drawn = [_drawn_by(seed, known) for seed in seeds] or [known]
    try:
        measured = [_measured(wanted, workers, one) for one in drawn]
    except KeyboardInterrupt as interrupted:
        raise RunInterruptedError("interrupted; nothing of it is kept") from interrupted
    found = []
    for dataset, cells in boards.items():
        logs = np.hstack([_logs(cells, one, FRESH) for one in measured])
        best, first = paired.best_method(logs), len(groups[dataset][0])
        over = paired.over(logs, best)
        found.append(
            FreshUnitResult(
                dataset,
                sum(cell.dataset == dataset for cell in scope.first(known)),
                first,
                cells[0],
                not paired.separate(logs, best)[0],
                float(over[0]),
                float(np.nanmin(over[:first])),
            )
        )
    return found


def _measured(wanted: Sequence[Cell], workers: int, parts: Parts) -> Mapping[Cell, Row]:
    with temporary_directory() as temporary:
        fresh = Store(temporary)
        run(wanted, fresh, workers, parts=parts)
        return fresh.scores()


def _drawn_by(seed: int, parts: Parts) -> Parts:
    """Return the data sets as if a seed were their version: everything is drawn anew."""
    presets = {
        name: replace(preset, version=seed, drawn_as=None) for name, preset in parts.presets.items()
    }
    return replace(parts, presets=presets)


def _of_level(cell: Cell, parts: Parts, *, in_flight: bool) -> Cell:
    flown = in_flight and FLIGHT in parts.presets[cell.dataset].conditions
    return replace(cell, condition=FLIGHT) if flown else cell


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
    """Print a line a board; exit code 1 where fewer than 95 % (in flight 90 %) hold.

    On the ground a leader holds in the first group; in flight the first group holds within 10 %.
    """
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("boards", nargs="*", metavar="DATASET", help="only these; all by default")
    parser.add_argument("--workers", type=int, default=1, help="processes that measure")
    parser.add_argument("--flight", action="store_true", help="errors in flight")
    parser.add_argument("--seed", type=int, action="append", default=[], help="may be repeated")
    options = parser.parse_args(arguments)
    if options.workers < 1:
        parser.error(f"--workers: expected a positive number, got {options.workers}")
    known = installed_parts()
    try:
        presets = {name: known.preset(name) for name in options.boards or known.presets}
    except UnknownNameError as error:
        parser.error(str(error))
    found = score_fresh_units(
        Store(PUBLISHED),
        options.workers,
        parts=replace(known, presets=presets),
        in_flight=options.flight,
        seeds=options.seed,
    )
    for one in found:
        sys.stdout.write(
            f"{one.dataset}: {one.first} of {one.pipelines} in the first group; "
            f"{one.leader.extractor} + {one.leader.model} "
            f"{'holds' if one.holds else 'is behind'} on fresh units, {one.over:.3f} of the first; "
            f"the best of the group {one.group_over:.3f}\n"
        )
    holds, near = sum(one.holds for one in found), sum(one.group_over <= NEAR for one in found)
    small = sum(one.first < 0.1 * one.pipelines for one in found)
    sys.stdout.write(
        f"{holds} of {len(found)} leaders are in the first group on {_units_of(options.seed)}; on "
        f"{near} boards the first group is within 10 % of the best; on {small} it has fewer than "
        "10 % of the pipelines\n"
    )
    return int(near < 0.9 * len(found) if options.flight else holds < 0.95 * len(found))


def _units_of(seeds: Sequence[int]) -> str:
    if not seeds:
        return f"units {FRESH[0]} to {FRESH[-1]}"
    return f"{len(FRESH) * len(seeds)} units drawn by {', '.join(map(str, seeds))}"


if __name__ == "__main__":
    call_to_end(main)
