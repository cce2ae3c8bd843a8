"""Tables of the bundle on the survey's claims: verdicts, criteria, trials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from benchmark.claims.ledger import Entry


def verdicts(entries: Sequence[Entry]) -> list[Mapping[str, Any]]:
    """Return a row for each claim."""
    return [
        {
            "claim": entry.claim.id,
            "claim_verdict": entry.verdict,
            "claim_case": entry.review.case,
            "claim_sentence": entry.review.sentence,
            "measured_on": entry.claim.measured_on,
            "replicate": entry.claim.replicate,
            "second_method": entry.claim.second,
            "second_agrees": entry.agrees,
            "explanation": entry.explanation,
        }
        for entry in entries
    ]


def rules(entries: Sequence[Entry]) -> list[Mapping[str, Any]]:
    """Return a row for each rule, with what the trials say of it."""
    return [
        {
            "claim": entry.claim.id,
            **{name: value for name, value in rule.items() if name != "trials"},
            "trials_count": rule["trials"],
        }
        for entry in entries
        for rule in entry.to_dict()["rules"]
    ]


def trials(entries: Sequence[Entry]) -> list[Mapping[str, Any]]:
    """Return a row for each rule and trial, with the number that was measured."""
    found: list[Mapping[str, Any]] = []
    for outcome in (entry.outcome for entry in entries if entry.outcome is not None):
        for rule, values in outcome.values.items():
            second = outcome.second.get(rule, (None,) * len(values))
            found += [
                {
                    "claim": outcome.claim,
                    "rule": rule,
                    "trial": number,
                    "statistic_value": value,
                    "second_value": other,
                }
                for number, (value, other) in enumerate(zip(values, second, strict=True))
            ]
    return found
