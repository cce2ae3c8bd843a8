"""A subject and its reference in turns: one process, one thread, so that whatever else the machine
does hits both. Ratios are of the best times; times themselves never fail anything.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

from benchmark.running.threads import one_thread
from tools.bench.verdicts import Verdict, any_broken


@dataclass(frozen=True)
class Subject:
    """Something to measure: calls that do the same work per item, and how they must compare.

    Attributes
    ----------
    name, reference_name
        What is measured, and against what.
    call, reference
        The work; each call does all of its items.
    items, reference_items
        How many items (frames, answers) a call does.
    limit
        Largest allowed ratio of time per item.
    worst, tolerance
        Largest difference between the two results, and the one allowed.
    clock
        What tells the time, s.
    """

    name: str
    reference_name: str
    call: Callable[[], object]
    reference: Callable[[], object]
    items: int
    reference_items: int
    limit: float
    worst: float = 0.0
    tolerance: float = 0.0
    clock: Callable[[], float] = time.perf_counter


@dataclass(frozen=True)
class Comparison:
    """A subject measured beside its reference; times are microseconds an item on one core."""

    name: str
    reference_name: str
    best_us: float
    median_us: float
    reference_best_us: float
    reference_median_us: float
    per_second: float
    ratio: float
    limit: float
    worst: float
    tolerance: float

    @property
    def agrees(self) -> bool:
        """Whether the subject gives its reference's result."""
        return self.worst <= self.tolerance

    @property
    def passes(self) -> bool:
        """Whether it agrees and keeps its limit."""
        return self.agrees and self.ratio <= self.limit


def compare(subject: Subject, repeats: int) -> Comparison:
    """Measure a subject and its reference in turns, after one call of each to warm up."""
    times: list[float] = []
    reference_times: list[float] = []
    with one_thread():
        subject.reference()
        subject.call()
        for _ in range(repeats):
            reference_times.append(
                _microseconds(subject.clock, subject.reference, subject.reference_items)
            )
            times.append(_microseconds(subject.clock, subject.call, subject.items))
    return Comparison(
        name=subject.name,
        reference_name=subject.reference_name,
        best_us=min(times),
        median_us=statistics.median(times),
        reference_best_us=min(reference_times),
        reference_median_us=statistics.median(reference_times),
        per_second=1e6 / min(times),
        ratio=min(times) / min(reference_times),
        limit=subject.limit,
        worst=subject.worst,
        tolerance=subject.tolerance,
    )


def _microseconds(clock: Callable[[], float], call: Callable[[], object], items: int) -> float:
    started = clock()
    call()
    return 1e6 * (clock() - started) / items


def verdicts(compared: Sequence[Comparison]) -> list[Verdict]:
    """Return two verdicts on each comparison: its ratio, and how far its result is off."""
    found = []
    for c in compared:
        found.append(Verdict(f"{c.name}: time over that of {c.reference_name}", c.ratio, c.limit))
        found.append(Verdict(f"{c.name}: result against the reference's", c.worst, c.tolerance))
    return found


def run(subjects: Sequence[Subject], repeats: int) -> list[Verdict]:
    """Measure, print as it goes, and return the verdicts."""
    found = []
    for subject in subjects:
        compared = compare(subject, repeats)
        _print(compared)
        found += verdicts([compared])
    return found


def main(
    program: str,
    subjects: Callable[[], Sequence[Subject]],
    repeats: int,
    arguments: Sequence[str] | None,
) -> int:
    """Be the command of a harness: measure, print, and return the exit status."""
    parser = argparse.ArgumentParser(prog=f"python -m {program}")
    parser.add_argument("--format", choices=("table", "json"), default="table")
    parser.add_argument(
        "--repeats", type=int, default=repeats, help=f"turns of each pair (default {repeats})"
    )
    given = parser.parse_args(arguments)
    if given.repeats < 1:
        parser.error(f"--repeats must be at least 1; got {given.repeats}")
    if given.format == "table":
        return 1 if any_broken(run(subjects(), given.repeats)) else 0
    compared = [compare(subject, given.repeats) for subject in subjects()]
    rows = [{**asdict(c), "agrees": c.agrees, "passes": c.passes} for c in compared]
    print(json.dumps({"comparisons": rows}, indent=2))
    return 1 if any_broken(verdicts(compared)) else 0


def _print(c: Comparison) -> None:
    print(f"{c.name}\n  against {c.reference_name}")
    print(f"  {'us per item':<14}{'best':>12}{'median':>12}")
    print(f"  {'subject':<14}{c.best_us:>12.3f}{c.median_us:>12.3f}")
    print(f"  {'reference':<14}{c.reference_best_us:>12.3f}{c.reference_median_us:>12.3f}")
    verdict = "kept" if c.ratio <= c.limit else "BROKEN"
    print(f"  ratio {c.ratio:.4f}, limit {c.limit:g}: {verdict}; {c.per_second:,.0f} a second")
    verdict = "agrees" if c.agrees else "DISAGREES"
    print(f"  result {verdict}: off by {c.worst:.2g} at most, {c.tolerance:g} allowed")
    print(flush=True)
