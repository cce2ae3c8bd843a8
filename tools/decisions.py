"""Print the figures that docs/decisions/ states, from the record: `python -m tools.decisions`."""

from __future__ import annotations

import statistics
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmark.leaderboard.board import board_of
from benchmark.results.store import PUBLISHED, Store

ROOT = Path(__file__).parents[1]
Row = Mapping[str, Any]


def first_boards() -> list[Sequence[Row]]:
    """Return the ranked rows of each data set's first condition."""
    return [
        [r for r in d["rows"] if r["condition"] == d["conditions"][0] and r["rank"] is not None]
        for d in board_of(Store())["datasets"]
    ]


def bench(boards: Sequence[Sequence[Row]]) -> str:
    """Compare the second extractor of a board with the first, by own error and on a bench."""
    pairs = []
    for rows in boards:
        best = sorted((r for r in rows if r["best_of_extractor"]), key=lambda r: r["rank"])
        if len(best) > 1 and best[1]["on_bench_deg"]:
            pairs.append(best[:2])
    ratios = (
        statistics.median(second[error] / first[error] for first, second in pairs)
        for error in ("own_error_deg", "on_bench_deg")
    )
    own, on_bench = ratios
    return (
        f"true-directions: of {len(pairs)} boards, error of the second extractor over the first's, "
        f"median: {own:.2f} own, {on_bench:.2f} on a bench"
    )


def groups(boards: Sequence[Sequence[Row]]) -> str:
    """Count what is not distinguished from the leaders of boards."""
    first = [sum(row["group"] == 1 for row in rows) for rows in boards]
    return (
        f"paired-judgement: of {len(first)} boards {first.count(1)} have one leader; median "
        f"{statistics.median(first):g} pipelines in the first group, at most {max(first)}"
    )


def sizes() -> str:
    """Measure the record and the lock files."""
    store = Store()
    scores = sum(path.stat().st_size for path in store.scores_directory.glob("*.csv"))
    locks = sum(path.stat().st_size for path in ROOT.glob("requirements*.lock"))
    return (
        f"record-in-git: {len(store.scores())} rows in {scores / 1e6:.1f} MB of CSV, digests of "
        f"code in {(PUBLISHED / 'components.json').stat().st_size / 1e3:.0f} kB\n"
        f"three-locks: {locks / 1e6:.2f} MB of lock files"
    )


if __name__ == "__main__":
    found = first_boards()
    sys.stdout.write("\n".join((bench(found), groups(found), sizes())) + "\n")
