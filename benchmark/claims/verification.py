"""Whether an outcome can be of its claim, and is what its experiment measures.

Digests in an outcome say of which code and plan it should be, not that its numbers are: these are
held against the plan, and trials drawn at random are made again.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from pathlib import Path

from benchmark.claims.experiment import Trial, found
from benchmark.claims.outcomes import PUBLISHED, Curve, Outcome, outcome_of, plan_digest, read
from benchmark.claims.rules import FIRST_TRIAL, Claim, claims

#: That of scores measured on another processor, and as much for the last of five digits.
TOLERANCE = 2e-4

Place = tuple[str, int]  # (claim, number of the trial)


def contradictions(claim: Claim, outcome: Outcome) -> Iterator[str]:
    """Say in what an outcome cannot be of its claim's plan; nothing where it can."""
    names = {rule.name for rule in claim.rules}
    for what, held in (("values", outcome.values), ("second", outcome.second)):
        wrong = set(held) ^ names if what == "values" else set(held) - names
        if wrong:
            yield f"{what}: expected those of {', '.join(sorted(names))}; {min(wrong)!r} is not so"
            return
        for name, numbers in held.items():
            yield from _of_numbers(claim, f"{what}, {name}", claim.rule(name).scale, numbers)
    if outcome.plan == plan_digest(claim) and bool(claim.second) != bool(outcome.second):
        yield "second: the plan and the outcome differ in whether there is a second method"
    for name, line in outcome.lines.items():
        for number, (low, median, high) in enumerate(
            zip(line.low, line.median, line.high, strict=True)
        ):
            if low > median or median > high:
                yield f"{name}, point {number + 1}: {median} is not between {low} and {high}"


def _of_numbers(claim: Claim, what: str, scale: str, numbers: Iterable[float]) -> Iterator[str]:
    given = list(numbers)
    if len(given) != claim.trials:
        yield f"{what}: expected {claim.trials} trials, got {len(given)}"
    if scale == "log" and any(value < 0 for value in given):
        yield f"{what}: a statistic averaged by logarithms is never negative; got {min(given)}"


def drawn(sample: int, seed: int, directory: Path = PUBLISHED) -> list[Place]:
    """Draw trials of measured claims; each one's lot is a digest of the seed and its name."""
    places = [
        (name, number)
        for name in read(directory)
        if name in found()
        for number in range(FIRST_TRIAL, FIRST_TRIAL + claims()[name].trials)
    ]

    def lot(place: Place) -> bytes:
        return hashlib.sha256(f"{seed} {place}".encode()).digest()

    return sorted(sorted(places, key=lot)[:sample])


def differences(places: Iterable[Place], directory: Path = PUBLISHED) -> Iterator[tuple[str, str]]:
    """Make trials again and give (file, what differs) of what is not as published.

    Ratios of run times are left aside, and the lines of claims that have any. Where all trials of a
    claim are made again, its lines are compared whole; else a trial's points have to lie between
    the extremes.
    """
    from benchmark.running.threads import one_thread  # noqa: PLC0415 - the service measures nothing

    outcomes = read(directory)
    for name, group in groupby(sorted(places), key=lambda place: place[0]):
        claim, outcome = claims()[name], outcomes[name]
        if wrong := list(contradictions(claim, outcome)):
            yield f"{name}.json", wrong[0]
            continue
        trials = []
        for _, number in group:
            with one_thread():
                trials.append(found()[name].trial(number))
            for text in _unlike(claim, outcome, trials[-1], number - FIRST_TRIAL):
                yield f"{name}.json", f"trial {number}: {text}"
        if len(trials) == claim.trials and not any(rule.timed for rule in claim.rules):
            made = outcome_of(claim, found()[name], trials)
            yield from ((f"{name}.json", text) for text in _unlike_lines(outcome, made))


def _unlike_lines(outcome: Outcome, made: Outcome) -> Iterator[str]:
    for name in sorted(outcome.lines.keys() ^ made.lines.keys()):
        yield f"line {name!r} is {'missing' if name in made.lines else 'none of this claim'}"
    for name in sorted(outcome.lines.keys() & made.lines.keys()):
        one, other = outcome.lines[name], made.lines[name]
        for part in ("median", "low", "high"):
            for number, pair in enumerate(
                zip(getattr(one, part), getattr(other, part), strict=False), start=1
            ):
                if not _alike(*pair):
                    said, should = pair
                    yield f"{name}, {part}, point {number} is {said}; measured again {should}"
        if one.across != other.across:
            yield f"{name}: across is not as measured again"


def _unlike(claim: Claim, outcome: Outcome, trial: Trial, place: int) -> Iterator[str]:
    timed = {rule.name for rule in claim.rules if rule.timed}
    both: tuple[tuple[str, Mapping[str, float], Mapping[str, tuple[float, ...]]], ...] = (
        ("values", trial.values, {k: tuple(v) for k, v in outcome.values.items()}),
        ("second", trial.second, {k: tuple(v) for k, v in outcome.second.items()}),
    )
    for what, measured, published in both:
        for name, values in published.items():
            again = measured.get(name, math.nan)
            if name not in timed and not _alike(values[place], again):
                yield f"{what}, {name} is {values[place]}; measured again it is {again:.5g}"
    if timed:
        return
    for name, (across, up) in trial.lines.items():
        line = outcome.lines.get(name)
        if line is None or len(line.across) != len(across):
            yield f"line {name!r}: not of {len(across)} points"
            continue
        yield from _outside(name, line, [float(value) for value in up])


def _outside(name: str, line: Curve, up: list[float]) -> Iterator[str]:
    for number, value in enumerate(up):
        low, high = line.low[number], line.high[number]
        if math.isnan(value):
            continue
        room = TOLERANCE * max(abs(low), abs(high))
        if not low - room <= value <= high + room:
            yield f"{name}, point {number + 1}: {value:.5g} is not between {low} and {high}"


def _alike(one: float, other: float) -> bool:
    if math.isnan(one) or math.isnan(other) or math.isinf(other):
        return math.isnan(one) and not math.isfinite(other)
    return math.isclose(one, other, rel_tol=TOLERANCE, abs_tol=1e-12)
