"""What the guide's chapter of findings says, from the record."""

from __future__ import annotations

from collections import Counter

from api.docs import front
from api.docs.markdown import table
from benchmark.claims.ledger import Entry, ledger
from benchmark.error_budget.record import RECORD as ERROR_BUDGET
from benchmark.error_budget.sentences import NEAR, PARTS, verdict

#: A selection of reproduced claims that affect a design.
USEFUL = ("C04", "C15", "C24", "C29", "C32", "C34", "C45", "C46", "C47", "C51", "C53")


def findings() -> str:
    """Give the findings of the README, their links as from the guide."""
    return _from_guide(front.findings())


def tallies() -> str:
    """Give the tallies of the README."""
    return _from_guide(front.tallies())


def refuted_claims() -> str:
    """List refuted claims with our results."""
    return "\n".join(
        f"- **“{entry.claim.statement}”** ({_where(entry)}). {entry.explanation}"
        for entry in ledger()
        if entry.verdict == "refuted"
    )


def useful() -> str:
    """List reproduced claims, each with its first criterion.

    Raises
    ------
    ValueError
        Where one of them has another verdict now: the choice is to be made again.
    """
    entries = {entry.claim.id: entry for entry in ledger()}
    changed = [name for name in USEFUL if entries[name].verdict != "reproduced"]
    if changed:
        raise ValueError(f"{', '.join(changed)}: not reproduced any more; choose others")
    rows = []
    for entry in (entries[name] for name in USEFUL):
        first = entry.rules[0]
        number = f"{first.estimate:.3g} [{first.low:.3g}, {first.high:.3g}]"
        rows.append((entry.claim.statement, first.rule.statistic, number, _where(entry)))
    return table(("claim", "criterion", "result [95 % interval]", "page"), rows)


def error_budget() -> str:
    """Count the largest error sources of the best pipelines."""
    judged = [verdict(row) for row in ERROR_BUDGET.read().values()]
    near = sum(one.near for one in judged)
    counted = Counter(PARTS[one.leading] for one in judged if not one.near)
    rows = [(part, str(number)) for part, number in sorted(counted.items(), key=_most_first)]
    return (
        f"The error of the best pipeline is within {NEAR:g} times the bound on {near} of "
        f"{len(judged)} data sets. Largest error source on the others:\n\n"
        + table(("error source", "data sets"), rows)
    )


def _most_first(counted: tuple[str, int]) -> tuple[int, str]:
    return -counted[1], counted[0]


def _where(entry: Entry) -> str:
    study = f", {entry.claim.study}" if entry.claim.study else ""
    return f"[{entry.claim.id}](../claims.md#{entry.claim.id.lower()}){study}"


def _from_guide(text: str) -> str:
    return text.replace("](docs/", "](../").replace("[docs/", "[")
