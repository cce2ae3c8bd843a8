"""Whether an outcome can be of its claim's plan.

Digests in an outcome say of which code and plan it should be, not that its numbers are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from benchmark.claims.outcomes import ClaimOutcome, plan_digest
from benchmark.claims.rules import Claim


def contradictions(claim: Claim, outcome: ClaimOutcome) -> Iterator[str]:
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
