"""Cells drawn at random from the record, measured again from nothing, and held against it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from benchmark.contract import Cell
from benchmark.leaderboard.check import Difference, compare_scores
from benchmark.plan.parts import Parts
from benchmark.progress import ProgressCallback
from benchmark.results.store import Store
from benchmark.running.runner import RunInterruptedError, run
from files.atomic import temporary_directory


@dataclass(frozen=True)
class VerificationResult:
    """What came of measuring cells again.

    `alike`: how many cells have every digit of the record; `differences`: beyond what
    `benchmark.leaderboard.check` allows another machine, or a score where there was none.
    """

    cells: tuple[Cell, ...]
    alike: int
    differences: tuple[Difference, ...]


def verify(
    cells: Iterable[Cell],
    record: Store,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    scheduler: str | None = None,
    parts: Parts | None = None,
) -> VerificationResult:
    """Measure cells from nothing and compare them with the record.

    A cell that the record lacks is a difference; nothing is written to the record. Other parameters
    and errors as `benchmark.running.runner.run`; on Ctrl-C nothing is kept.
    """
    wanted = sorted(set(cells))
    try:
        with temporary_directory() as temporary:
            again = Store(temporary)
            run(
                wanted,
                again,
                workers,
                progress,
                scheduler=scheduler,
                parts=parts,
                keep_stages=False,
            )
            measured, pins = again.scores(), again.pins()
    except KeyboardInterrupt as interrupted:
        raise RunInterruptedError(
            "interrupted; verifying keeps nothing of what it measured"
        ) from interrupted
    stored = record.scores()
    committed = {cell: stored[cell] for cell in wanted if cell in stored}
    samples = {
        place[:2]: pin.n for place, pin in {**pins, **record.pins()}.items() if place[2] == "test"
    }
    return VerificationResult(
        tuple(wanted),
        sum(committed.get(cell) == measured[cell] for cell in wanted),
        tuple(compare_scores(committed, measured, samples)),
    )
