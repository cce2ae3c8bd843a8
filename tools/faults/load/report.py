"""What a load says: statuses, times by kind, memory; and whether that is as wanted."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Sequence

from tools.faults.load.driving import Load

#: Answers that stay below this many medians, and their share.
TIMES, SHARE = 10.0, 0.99
#: When memory is to be level, seconds; the mean of this long is compared, and may rise by so much.
LEVEL_AFTER_S, WINDOW_S, GROWTH = 600.0, 300.0, 0.02


def failures(load: Load) -> list[str]:
    """Say what is not as wanted, one sentence each."""
    found = []
    broken = [one for one in load.answers if one.status == 0 or one.status >= 500]
    if broken:
        kinds = ", ".join(f"{one.status} {one.path}" for one in broken[:5])
        found.append(f"{len(broken)} answers are 5xx or none: {kinds}")
    took = [one.took_s for one in load.answers]
    share = quick_share(took)
    if share < SHARE:
        found.append(
            f"{share:.2%} of the answers took less than {TIMES:g} medians, not {SHARE:.0%}"
        )
    growth = memory_growth(load)
    if growth is not None and growth > GROWTH:
        found.append(f"memory rose by {growth:.1%} after ten minutes")
    return found


def quick_share(took: Sequence[float]) -> float:
    """Return the share of answers below `TIMES` medians."""
    limit = TIMES * statistics.median(took)
    return sum(one < limit for one in took) / len(took)


def memory_growth(load: Load) -> float | None:
    """Return how much its own memory rose from ten minutes on; None for too short a run."""
    early = [m for at, m in load.memory if LEVEL_AFTER_S <= at < LEVEL_AFTER_S + WINDOW_S]
    late = [m for at, m in load.memory if at >= load.seconds - WINDOW_S]
    if not early or not late or load.seconds < LEVEL_AFTER_S + 2 * WINDOW_S:
        return None
    return statistics.mean(late) / statistics.mean(early) - 1.0


def report(load: Load) -> str:
    """Return the tables, in Markdown."""
    took = [one.took_s for one in load.answers]
    statuses = Counter(one.status for one in load.answers)
    growth = memory_growth(load)
    late = sum(one.late_s > 0.05 for one in load.answers) / len(took)
    counted = ", ".join(f"{number} of {status}" for status, number in sorted(statuses.items()))
    level = (
        "the run is too short to tell whether it is constant"
        if growth is None
        else f"between minutes 10 to 15 and the last five minutes it changed by {growth:+.2%}"
    )
    lines = [
        (
            f"{len(load.answers)} requests in {load.seconds / 60:.0f} minutes at {load.rate:g} a "
            f"second; statuses: {counted}."
        ),
        "",
        (
            f"Median {1e3 * statistics.median(took):.1f} ms; {quick_share(took):.2%} below ten "
            f"times that; 99 % below {1e3 * _quantile(took, 0.99):.0f} ms, the longest "
            f"{1e3 * max(took):.0f} ms. The client sent more than 50 ms late for {late:.2%} of "
            "the requests."
        ),
        "",
        f"Private memory (not backed by files) after {_minutes(load.memory)}; {level}.",
        f"Resident memory, including pages of files: {_minutes(load.resident)}.",
        "",
        "| requests | number | median, ms | 99 % below, ms | longest, ms |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    for kind in sorted({one.kind for one in load.answers}):
        some = [1e3 * one.took_s for one in load.answers if one.kind == kind]
        lines.append(
            f"| {kind} | {len(some)} | {statistics.median(some):.1f} | "
            f"{_quantile(some, 0.99):.0f} | {max(some):.0f} |"
        )
    return "\n".join(lines) + "\n"


def _minutes(memory: Sequence[tuple[float, int]]) -> str:
    said = []
    for minute in (1, 5, 10, 20, 30, 40, 50, 60):
        near = [m for at, m in memory if 60 * minute - 30 <= at < 60 * minute + 30]
        if near:
            said.append(f"{minute} min {statistics.mean(near) / 1e6:.0f} MB")
    return ", ".join(said) or "less than a minute"


def _quantile(values: Sequence[float], share: float) -> float:
    return sorted(values)[min(int(share * len(values)), len(values) - 1)]
