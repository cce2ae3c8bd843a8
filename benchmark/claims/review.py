"""The second reading of every claim: the sentence of the survey, and whether the trial is its case.

`claims_review.csv` has a row a claim. A quotation is word for word from the survey's LaTeX source,
in the line that is named; `context` is what names the sensor where the sentence does not.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Literal

from benchmark.claims.rules import DIRECTORY, Verdict, rows_of

#: Whether sensor, condition and comparison of the trial are those of the sentence.
Case = Literal["its case", "partly its case", "not its case"]

REVIEW = DIRECTORY / "claims_review.csv"
_CITATIONS = re.compile(r"\s*\\cite\{[^}]*\}")
_MATHS = (("^{\\circ}", "°"), ("^{-1/2}", "^-1/2"), ("4\\pi", "4π"), ("$", ""))


@dataclass(frozen=True)
class Review:
    """What the second reading of a claim found.

    Line and sentence are of the survey's source, word for word; the context names the sensor where
    the sentence does not. `detector`, `mask` are values of the taxonomy that these words allow, or
    "any"; `trial` are data sets, or the module that draws the readings. The verdict is as
    published, and the reason is of the case.
    """

    line: str
    sentence: str
    context_line: str
    context: str
    detector: tuple[str, ...]
    mask: tuple[str, ...]
    trial: tuple[str, ...]
    trial_detector: tuple[str, ...]
    trial_mask: tuple[str, ...]
    case: Case
    verdict: str
    reason: str

    @property
    def quotation(self) -> str:
        """The sentence without marks of LaTeX."""
        said = _CITATIONS.sub("", self.sentence)
        for mark, plain in _MATHS:
            said = said.replace(mark, plain)
        return said


COLUMNS = ("claim", *(field.name for field in fields(Review)))


def published(found: Verdict, case: Case) -> Verdict:
    """Return the verdict on the survey's sentence: nothing refutes it but its own case."""
    return "not reproduced here" if found == "refuted" and case != "its case" else found


@cache
def reviews(path: Path = REVIEW) -> Mapping[str, Review]:
    """Return the reading of each claim."""
    found: dict[str, Review] = {}
    for row in rows_of(path, COLUMNS):
        lists = {
            name: tuple(row[name].split("; "))
            for name in ("detector", "mask", "trial", "trial_detector", "trial_mask")
        }
        rest = {name: row[name] for name in COLUMNS if name != "claim" and name not in lists}
        found[row["claim"]] = Review(**rest, **lists)  # type: ignore[arg-type]
    return found


FORMER_COLUMNS = (
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
    rows = rows_of(DIRECTORY / "former_outcomes.csv", FORMER_COLUMNS)
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
