"""What docs/claims.md says of the survey's claims, and their plots."""

from __future__ import annotations

import math
from functools import cache

from api.docs.markdown import table
from benchmark.claims.judgement import Judgement
from benchmark.claims.ledger import Entry, ledger, tally
from benchmark.claims.plots import file_of
from survey_data import labels


def counts() -> str:
    """Count the claims by verdict, and say how the second methods came out."""
    entries = _entries()
    counted = ", ".join(f"{number} {verdict}" for verdict, number in tally(entries).items())
    second = [entry for entry in entries if entry.agrees is not None]
    names = ", ".join(_link(entry) for entry in second)
    agree = sum(bool(entry.agrees) for entry in second)
    return (
        f"**{len(entries)} claims: {counted}.** {len(second)} were checked by a second method "
        f"({names}); it says the same of every rule for {agree} of them."
    )


def verdicts() -> str:
    """List every claim with its verdict, linked to its trial."""
    rows = [
        (
            _link(entry),
            entry.claim.statement,
            entry.claim.study,
            f"**{entry.verdict or 'not measured'}**",
        )
        for entry in _entries()
    ]
    return table(("id", "claim", "study", "verdict"), rows)


def trials() -> str:
    """Tell each trial: data, rules with their numbers, second method, explanation, plot."""
    return "\n\n".join(_section(entry) for entry in _entries())


@cache
def _entries() -> tuple[Entry, ...]:
    return ledger()


def _section(entry: Entry) -> str:
    said = entry.claim
    study = f", {said.study}" if said.study else ""
    verdict = (entry.verdict or "not measured").capitalize()
    lines = [
        f"### {said.id}",
        f"“{said.statement}” ({labels.name(said.section)}{study})",
        f"**{verdict}.** {labels.label_of(entry.explanation)}".strip(),
        f"Measured on: {said.measured_on}. Trials: {said.trials} {said.replicate}s.",
    ]
    if entry.rules:
        second = {rule.rule.name: rule for rule in entry.second}
        rows = [_row(rule, second.get(rule.rule.name)) for rule in entry.rules]
        head = ("statistic", "holds if", "mean [95 %]", "")
        other = ("second method",) if second else ()
        lines.append(table((*head, *other), [row[: len(head) + len(other)] for row in rows]))
    if said.second and entry.second:
        lines.append(f"Second method: {said.second}.")
    if _has_plot(entry):
        lines.append(f"![{said.up} against {said.across}]({file_of(said.id)})")
    return "\n\n".join(lines)


def _row(one: Judgement, second: Judgement | None) -> tuple[str, ...]:
    timed = " (run times)" if one.rule.timed else ""
    return (
        f"{one.rule.statistic}{timed}",
        str(one.rule),
        _numbers(one),
        one.standing,
        f"{_numbers(second)}, {second.standing}" if second else "",
    )


def _numbers(one: Judgement) -> str:
    if math.isnan(one.estimate):
        return f"none ({one.trials} trials)" if not math.isfinite(one.high) else "unbounded"
    return f"{one.estimate:.3g} [{one.low:.3g}, {one.high:.3g}]"


def _link(entry: Entry) -> str:
    return f"[{entry.claim.id}](#{entry.claim.id.lower()})"


def _has_plot(entry: Entry) -> bool:
    return entry.outcome is not None and bool(entry.outcome.lines)
