"""Speed as ratios to references measured in the same run: ``python -m tests.speed.simulator``.

Each subject and its reference take turns in one process on one thread, so that whatever else the
machine does hits both. Ratios are of the best times. Exit status 1 when a ratio is above its limit
or a subject does not give its reference's result; times themselves never fail anything.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

from benchmark.running.threads import one_thread
from tests.speed.frames import frames_of_a_coded_mask, frames_of_many_spots
from tests.speed.light import diffracted_frames, light_of_frames
from tests.speed.references import centroid_of_spots, rendering_of_frames


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
        How many items (frames) a call does.
    limit
        Largest allowed ratio of time per item.
    worst, tolerance
        Largest difference between the two results, and the one allowed.
    """

    name: str
    reference_name: str
    call: Callable[[], object]
    reference: Callable[[], object]
    items: int
    reference_items: int
    limit: float
    worst: float
    tolerance: float


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
            reference_times.append(_microseconds(subject.reference, subject.reference_items))
            times.append(_microseconds(subject.call, subject.items))
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


def _microseconds(call: Callable[[], object], items: int) -> float:
    started = time.perf_counter()
    call()
    return 1e6 * (time.perf_counter() - started) / items


def subjects() -> list[Subject]:
    """Prepare everything that is measured; a slower one is repeated as often."""
    prepared = (
        centroid_of_spots,
        rendering_of_frames,
        light_of_frames,
        diffracted_frames,
        frames_of_many_spots,
        frames_of_a_coded_mask,
    )
    return [Subject(**prepare()) for prepare in prepared]


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tests.speed.simulator", description=__doc__)
    parser.add_argument("--format", choices=("table", "json"), default="table")
    parser.add_argument("--repeats", type=int, default=15, help="turns of each pair (default 15)")
    given = parser.parse_args(arguments)
    if given.repeats < 1:
        parser.error(f"--repeats must be at least 1; got {given.repeats}")
    compared = [compare(subject, given.repeats) for subject in subjects()]
    if given.format == "json":
        rows = [{**asdict(c), "agrees": c.agrees, "passes": c.passes} for c in compared]
        print(json.dumps({"comparisons": rows}, indent=2))
    else:
        _print_table(compared)
    return 0 if all(comparison.passes for comparison in compared) else 1


def _print_table(compared: Sequence[Comparison]) -> None:
    for c in compared:
        print(f"{c.name}\n  against {c.reference_name}")
        print(f"  {'us per frame':<14}{'best':>12}{'median':>12}")
        print(f"  {'subject':<14}{c.best_us:>12.3f}{c.median_us:>12.3f}")
        print(f"  {'reference':<14}{c.reference_best_us:>12.3f}{c.reference_median_us:>12.3f}")
        verdict = "kept" if c.ratio <= c.limit else "BROKEN"
        print(f"  ratio {c.ratio:.4f}, limit {c.limit:g}: {verdict}; {c.per_second:,.0f} a second")
        verdict = "agrees" if c.agrees else "DISAGREES"
        print(f"  result {verdict}: off by {c.worst:.2g} at most, {c.tolerance:g} allowed\n")


if __name__ == "__main__":
    sys.exit(main())
