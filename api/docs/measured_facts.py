"""What the guide's chapter of findings says, from the record."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from api.docs import front
from api.docs.markdown import table
from benchmark.claims.judgement import Judgement
from benchmark.claims.ledger import Entry, ledger
from benchmark.error_budget.record import RECORD as ERROR_BUDGET
from benchmark.error_budget.sentences import NEAR, PARTS, verdict

#: A selection of reproduced claims that affect a design.
USEFUL = ("C04", "C11", "C15", "C16", "C21", "C24", "C29", "C34", "C47", "C51", "C53")


def findings() -> str:
    """Give the findings of the README, their links as from the guide."""
    return _from_guide(front.findings())


def tallies() -> str:
    """Give the tallies of the README."""
    return _from_guide(front.tallies())


def claims_not_reproduced() -> str:
    """List claims of which no criterion holds, each with its first criterion that fails."""
    return _criteria(
        (entry, next(rule for rule in entry.rules if rule.result == "fails"))
        for entry in ledger()
        if entry.verdict in {"not reproduced here", "refuted"}
    )


def reproduced_claims() -> str:
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
    return _criteria((entries[name], entries[name].rules[0]) for name in USEFUL)


def error_budget() -> str:
    """Count the largest error sources of the best pipelines."""
    judged = [verdict(row) for row in ERROR_BUDGET.read().values()]
    near = sum(one.is_near_bound for one in judged)
    counted = Counter(PARTS[one.leading_part] for one in judged if not one.is_near_bound)
    rows = [(part, str(number)) for part, number in sorted(counted.items(), key=_most_first)]
    return (
        f"The error of the best pipeline is within {NEAR:g} times the bound on {near} of "
        f"{len(judged)} data sets. Largest error source on the others:\n\n"
        + table(("error source", "data sets"), rows)
    )


def _criteria(chosen: Iterable[tuple[Entry, Judgement]]) -> str:
    """Tabulate claims, each with one criterion and its result."""
    rows = [
        (
            entry.claim.statement,
            one.rule.statistic,
            f"{one.estimate:.3g} [{one.low:.3g}, {one.high:.3g}]",
            _where(entry),
        )
        for entry, one in chosen
    ]
    return table(("claim", "criterion", "result [95 % interval]", "page"), rows)


def _most_first(counted: tuple[str, int]) -> tuple[int, str]:
    return -counted[1], counted[0]


def _where(entry: Entry) -> str:
    study = f", {entry.claim.study}" if entry.claim.study else ""
    return f"[{entry.claim.id}](../claims.md#{entry.claim.id.lower()}){study}"


def _from_guide(text: str) -> str:
    return text.replace("](docs/", "](../").replace("[docs/", "[")
