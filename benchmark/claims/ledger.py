"""The claims with their verdicts: what the command line, HTTP and the docs tell."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmark.claims.judgement import Judgement, judge, verdict
from benchmark.claims.outcomes import RECORD, ClaimOutcome, contradictions, read_outcomes
from benchmark.claims.review import FormerOutcome, Review, former_outcomes, published, reviews
from benchmark.claims.rules import DIRECTORY, VERDICTS, Claim, Verdict, claims, rows_of
from benchmark.results.store import PUBLISHED
from survey_data import labels

EXPLANATIONS = DIRECTORY / "explanations.csv"


class LedgerError(ValueError):
    """An explanation that fits no verdict; the message names both."""


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

    LedgerError where an explanation was written for another verdict than the one that is measured,
    or an outcome cannot be of its claim's plan.
    """
    outcomes, written = read_outcomes(directory), _explanations(explanations)
    if unknown := sorted(set(written) - set(claims())):
        raise LedgerError(f"{explanations.name} explains no claim of the survey: {unknown}")
    return tuple(
        _entry(claim, outcomes.get(name), written.get(name, ("", "")))
        for name, claim in claims().items()
    )


def tally(entries: Iterable[Entry]) -> dict[str, int]:
    """Count the claims by verdict; "not measured" where there is such."""
    counts = Counter(entry.verdict or "not measured" for entry in entries)
    known = {name: counts[name] for name in VERDICTS}
    return known | ({"not measured": counts["not measured"]} if counts["not measured"] else {})


def _entry(claim: Claim, outcome: ClaimOutcome | None, written: tuple[str, str]) -> Entry:
    about, said = written
    review, former = reviews()[claim.id], former_outcomes().get(claim.id, ())
    if outcome is None:
        rules = tuple(judge(rule, ()) for rule in claim.rules)
        return Entry(claim, None, review, former, rules, (), said, None)
    if wrong := next(contradictions(claim, outcome), ""):
        raise LedgerError(
            f"{RECORD.name}: {claim.id}: {wrong}; measure it again with "
            f"`python -m benchmark.experiments claims {claim.id}`"
        )
    rules = tuple(judge(rule, outcome.values[rule.name]) for rule in claim.rules)
    second = tuple(judge(claim.rule(name), values) for name, values in outcome.second.items())
    found = published(verdict(rules), review.case)
    if about and about != found:
        raise LedgerError(
            f"{claim.id} is explained as {about!r} and comes out as {found!r}: read the numbers "
            f"and write its line in {EXPLANATIONS.name} anew"
        )
    return Entry(claim, found, review, former, rules, second, said, outcome)


def _explanations(path: Path) -> Mapping[str, tuple[str, str]]:
    found: dict[str, tuple[str, str]] = {}
    for row in rows_of(path, ("claim", "verdict", "says")):
        if row["claim"] in found:
            raise LedgerError(f"{path.name}: claim {row['claim']} stands there twice")
        found[row["claim"]] = row["verdict"], row["says"]
    return found


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
