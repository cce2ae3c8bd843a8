"""`python -m benchmark.claims.run`: measure what is not measured, or what changed."""

from __future__ import annotations

import argparse
import secrets
import sys
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

from benchmark.claims.experiment import Trial, found
from benchmark.claims.outcomes import PUBLISHED, outcome_of, read, stale, write
from benchmark.claims.rules import FIRST_TRIAL, claims
from benchmark.claims.verification import contradictions, differences, drawn
from benchmark.contract import UnknownNameError
from benchmark.processes import call_to_end
from benchmark.running.threads import one_thread
from benchmark.running.workers import in_order
from files.locks import lock_or_refuse


def measured(claim: str) -> list[Trial]:
    """Make every trial of a claim, one after the other.

    Raises
    ------
    UnknownNameError
        For a claim that has no experiment.
    """
    if claim not in found():
        raise UnknownNameError("experiment on claim", claim, found())
    with one_thread():
        last = FIRST_TRIAL + claims()[claim].trials
        return [found()[claim].trial(number) for number in range(FIRST_TRIAL, last)]


def due(directory: Path = PUBLISHED) -> dict[str, str]:
    """Why each claim has to be measured (again), for those that have to be."""
    outcomes = read(directory)
    reasons = {
        name: stale(claims()[name], experiment, outcomes.get(name))
        for name, experiment in found().items()
    }
    for name in outcomes.keys() & reasons.keys():
        wrong = next(contradictions(claims()[name], outcomes[name]), "")
        reasons[name] = reasons[name] or wrong
    return {name: reason for name, reason in reasons.items() if reason}


def run(
    names: Sequence[str] | None = None, directory: Path = PUBLISHED, workers: int = 1
) -> list[str]:
    """Measure the named claims, or all that are due; return them.

    Each outcome is written as soon as it is there, the same whatever the number of workers, but
    for ratios of run times.

    Raises
    ------
    UnknownNameError
        For a claim that has no experiment.
    LockedError
        When another process measures claims.
    """
    directory.mkdir(parents=True, exist_ok=True)
    with lock_or_refuse(directory / "outcomes"):
        chosen = list(due(directory) if names is None else names)
        for name in chosen:
            if name not in found():
                raise UnknownNameError("experiment on claim", name, found())
        with closing(in_order(measured, chosen, workers)) as results:
            for name, trials in zip(chosen, results, strict=True):
                write(outcome_of(claims()[name], found()[name], trials), directory)
                sys.stderr.write(f"{name} measured\n")
    return chosen


def _again(directory: Path, sample: int, seed: int | None) -> int:
    number = secrets.randbelow(10**6) if seed is None else seed
    places = drawn(sample, number, directory)
    sys.stderr.write(f"{len(places)} trials, drawn by --seed {number}\n")
    count = 0
    for file, text in differences(places, directory):
        sys.stdout.write(f"{file}: {text}\n")
        count += 1
    sys.stderr.write(f"{count} differences\n")
    return 1 if count else 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure claims and write their outcomes; with --check only say what is due (exit code 1).

    With --again trials drawn at random are made anew and compared; nothing is written.
    """
    parser = argparse.ArgumentParser(
        prog="python -m benchmark.claims.run", description=main.__doc__
    )
    parser.add_argument(
        "claims", nargs="*", help="only these, due or not; all that are due if none"
    )
    parser.add_argument("--directory", type=Path, default=PUBLISHED)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--check", action="store_true", help="measure nothing")
    parser.add_argument("--again", type=int, metavar="K", help="make K trials again and compare")
    parser.add_argument("--seed", type=int, help="draws the same trials again; else others")
    options = parser.parse_args(arguments)
    if options.check:
        waiting = due(options.directory)
        for name, reason in waiting.items():
            sys.stdout.write(f"{name}: {reason}\n")
        return 1 if waiting else 0
    if options.again is not None:
        return _again(options.directory, options.again, options.seed)
    run(options.claims or None, options.directory, options.workers)
    return 0


if __name__ == "__main__":
    call_to_end(main)
