"""The claims with their verdicts: what the command line, HTTP and the docs tell."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmark.claims.judgement import Judgement, judge, verdict
from benchmark.claims.outcomes import ClaimOutcome, read_outcomes
from benchmark.claims.review import FormerOutcome, Review, former_outcomes, published, reviews
from benchmark.claims.rules import DIRECTORY, VERDICTS, Claim, Verdict, claims, rows_of
from benchmark.results.store import PUBLISHED
from survey_data import labels

EXPLANATIONS = DIRECTORY / "explanations.csv"


@dataclass(frozen=True)
class Entry:
    """One claim, as it came out.

    The verdict is by the trials and by whether they are the sentence's case; None, as the outcome,
    where it was not measured. `former` are outcomes before criteria or data were changed, oldest
    first. `second` are those rules that the second method measures. The explanation says why it is
    not, or not wholly, so; empty where it is reproduced.
    """

    claim: Claim
    verdict: Verdict | None
    review: Review
    former: tuple[FormerOutcome, ...]
    rules: tuple[Judgement, ...]
    second: tuple[Judgement, ...]
    explanation: str
    outcome: ClaimOutcome | None

    @property
    def agrees(self) -> bool | None:
        """Whether the second method says of every rule what the first says; None without one."""
        first = {rule.rule.name: rule.result for rule in self.rules}
        if not self.second:
            return None
        return all(first[rule.rule.name] == rule.result for rule in self.second)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON values; NaN is None."""
        said = self.claim
        return {
            "id": said.id,
            "section": said.section,
            "section_name": labels.name(said.section),
            "study": said.study,
            "statement": said.statement,
            "verdict": self.verdict,
            "explanation": self.explanation,
            "case": self.review.case,
            "measured_on": said.measured_on,
            "trials": said.trials,
            "replicate": said.replicate,
            "rules": [_rule(rule) for rule in self.rules],
            "second_method": said.second,
            "second_agrees": self.agrees,
            "second": [_rule(rule) for rule in self.second],
        }


def ledger(
    directory: Path | str = PUBLISHED, explanations: Path = EXPLANATIONS
) -> tuple[Entry, ...]:
    """Return every claim with its verdict, in the survey's order.

    An explanation that was written for another verdict than the one that is measured is left out.
    """
    outcomes = read_outcomes(directory)
    written = {
        (row["claim"], row["verdict"]): row["says"]
        for row in rows_of(explanations, ("claim", "verdict", "says"))
    }
    return tuple(_entry(claim, outcomes.get(name), written) for name, claim in claims().items())


def tally(entries: Iterable[Entry]) -> dict[str, int]:
    """Count the claims by verdict; "not measured" where there is such."""
    counts = Counter(entry.verdict or "not measured" for entry in entries)
    known = {name: counts[name] for name in VERDICTS}
    return known | ({"not measured": counts["not measured"]} if counts["not measured"] else {})


def _entry(
    claim: Claim, outcome: ClaimOutcome | None, written: Mapping[tuple[str, str], str]
) -> Entry:
    review, former = reviews()[claim.id], former_outcomes().get(claim.id, ())
    if outcome is None:
        rules = tuple(judge(rule, ()) for rule in claim.rules)
        return Entry(claim, None, review, former, rules, (), "", None)
    rules = tuple(judge(rule, outcome.values[rule.name]) for rule in claim.rules)
    second = tuple(judge(claim.rule(name), values) for name, values in outcome.second.items())
    found = published(verdict(rules), review.case)
    said = written.get((claim.id, found), "")
    return Entry(claim, found, review, former, rules, second, said, outcome)


def _rule(one: Judgement) -> dict[str, Any]:
    return {
        "rule": one.rule.name,
        "statistic": one.rule.statistic,
        "decides": str(one.rule),
        "result": one.result,
        "estimate": _number(one.estimate),
        "low": _number(one.low),
        "high": _number(one.high),
        "trials": one.trials,
        "timed": one.rule.timed,
    }


def _number(value: float) -> float | None:
    return float(f"{value:.5g}") if math.isfinite(value) else None
