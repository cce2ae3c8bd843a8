"""Outcomes of claims whose criteria or data were changed after them, as published then.

`former_outcomes.csv` was written once from the records of 24 and 29 November 2026. It is history:
nothing renews it. `outcome` numbers the former outcomes of a claim; the present one comes after.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import groupby

from benchmark.claims.rules import DIRECTORY, rows_of

COLUMNS = (
    "claim",
    "outcome",
    "measured_on",
    "verdict",
    "rule",
    "statistic",
    "decides",
    "estimate",
    "low",
    "high",
    "result",
    "trials",
    "timed",
)


@dataclass(frozen=True)
class FormerRule:
    """A former criterion of a claim; None where it had no number."""

    rule: str
    statistic: str
    decides: str
    result: str
    estimate: float | None
    low: float | None
    high: float | None
    trials: int
    timed: bool


@dataclass(frozen=True)
class FormerOutcome:
    """A former outcome of a claim, by the criteria and data of then."""

    measured_on: str
    verdict: str
    rules: tuple[FormerRule, ...]


@cache
def former_outcomes() -> Mapping[str, tuple[FormerOutcome, ...]]:
    """Return the former outcomes of the claims that have any, oldest first."""
    rows = rows_of(DIRECTORY / "former_outcomes.csv", COLUMNS)
    found: dict[str, list[FormerOutcome]] = {}
    for (claim, _), group in groupby(rows, key=lambda row: (row["claim"], row["outcome"])):
        rules = list(group)
        criteria = tuple(
            FormerRule(
                row["rule"],
                row["statistic"],
                row["decides"],
                row["result"],
                _number(row["estimate"]),
                _number(row["low"]),
                _number(row["high"]),
                int(row["trials"]),
                row["timed"] == "yes",
            )
            for row in rules
        )
        one = FormerOutcome(rules[0]["measured_on"], rules[0]["verdict"], criteria)
        found.setdefault(claim, []).append(one)
    return {claim: tuple(outcomes) for claim, outcomes in found.items()}


def _number(text: str) -> float | None:
    return float(text) if text else None
