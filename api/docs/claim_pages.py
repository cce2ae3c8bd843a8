"""What docs/claims.md says of the survey's claims, and their plots."""

from __future__ import annotations

import math
from collections import Counter
from functools import cache

from benchmark.claims.former import FormerRule
from benchmark.claims.judgement import Judgement
from benchmark.claims.ledger import Entry, ledger, tally
from benchmark.claims.plots import file_of
from survey_data import labels


def counts() -> str:
    """Count the claims by verdict, and say how the second methods came out."""
    entries = _entries()
    counted = ", ".join(f"{number} {verdict}" for verdict, number in tally(entries).items())
    second = [entry for entry in entries if entry.agrees is not None]
    names = ", ".join(map(_link, second))
    cases = Counter(entry.review.case for entry in entries)
    changed = sum(bool(entry.former) for entry in entries)
    agree = sum(bool(entry.agrees) for entry in second)
    return (
        f"**{len(entries)} claims: {counted}.** The trial is the sentence's case for "
        f"{cases['its case']}, partly for {cases['partly its case']}. Criteria or data of "
        f"{changed} were changed after an outcome; every outcome is given. "
        f"{len(second)} were checked by a second method "
        f"({names}); it says the same of every rule for {agree} of them."
    )


def verdicts() -> str:
    """List the claims by verdict, and those that were changed, linked to their trials."""
    by_verdict: dict[str, list[str]] = {name: [] for name in tally(_entries())}
    for entry in _entries():
        by_verdict.setdefault(entry.verdict or "not measured", []).append(_link(entry))
    by_verdict["changed after an outcome"] = [_link(one) for one in _entries() if one.former]
    return "\n".join(
        f"- **{name}**: {', '.join(links) or 'none'}" for name, links in by_verdict.items()
    )


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
        f"{said.statement} ({labels.name(said.section)}{study})",
        f"> {entry.review.quotation} (line {entry.review.line})",
        f"**{verdict}.** {labels.label_of(entry.explanation)}".strip(),
        f"Trial: {entry.review.case}. {entry.review.reason}",
        f"Measured on: {said.measured_on}. Trials: {said.trials} {said.replicate}s.",
    ]
    if entry.rules:
        lines.append("\n".join(_rule(one) for one in entry.rules))
    if said.second and entry.second:
        others = [_rule(one) for one in entry.second if one not in entry.rules]
        lines.append(f"Second method, {said.second}: {'' if others else 'the same numbers.'}")
        if others:
            lines.append("\n".join(others))
    for one in entry.former:
        lines.append(f"Before a change, measured on {one.measured_on}: {one.verdict}.")
        lines.append("\n".join(_former_rule(rule) for rule in one.rules))
    if _has_plot(entry):
        lines.append(f"![{said.up} against {said.across}]({file_of(said.id)})")
    return "\n\n".join(lines)


def _rule(one: Judgement) -> str:
    timed = " (run times)" if one.rule.timed else ""
    return f"- {one.rule.statistic}{timed}: {_numbers(one)}; {one.rule}: **{one.result}**"


def _former_rule(one: FormerRule) -> str:
    given = [math.nan if x is None else x for x in (one.estimate, one.low, one.high)]
    numbers = "{:.4g} [{:.4g}, {:.4g}]".format(*given)
    return f"- {one.statistic}: {numbers}; {one.decides}: **{one.result}**"


def _numbers(one: Judgement) -> str:
    if math.isnan(one.estimate):
        return f"none ({one.trials} trials)" if not math.isfinite(one.high) else "unbounded"
    return f"{one.estimate:.3g} [{one.low:.3g}, {one.high:.3g}]"


def _link(entry: Entry) -> str:
    return f"[{entry.claim.id}](#{entry.claim.id.lower()})"


def _has_plot(entry: Entry) -> bool:
    return entry.outcome is not None and bool(entry.outcome.lines)
