"""What came of every direction: its verdict by its rule, and the numbers that decide."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from statistics import median
from typing import Any

from benchmark.directions.duels import Duel, duels, verdict
from benchmark.directions.paper import CALCULATIONS, Calculation
from benchmark.directions.rules import NOT_TRIED, Rule, rules
from benchmark.directions.trials import laser

Row = Mapping[str, Any]


def outcomes(rows: Iterable[Row], spoofed: Sequence[Row] = ()) -> list[dict[str, Any]]:
    """Return the outcome of every rule, in order.

    Parameters
    ----------
    rows
        Scores of all units (`Store.rows(unit=None)`).
    spoofed
        Rows of the experiment with lasers.
    """
    scored = list(rows)
    return [_outcome(rule, scored, spoofed) for rule in rules().values()]


def _outcome(rule: Rule, rows: Sequence[Row], spoofed: Sequence[Row]) -> dict[str, Any]:
    found: list[Duel] = []
    sensors: Sequence[Row] = ()
    value: float | None = None
    against: float | None = None
    if rule.kind == "paper":
        one = _calculated(rule.first)
        decided, text = ("pays" if one.pays else "does not pay"), one.text
        value, against, unit = one.value, one.against, one.unit
    elif rule.kind == "duel":
        found = duels(rule, rows)
        decided, text, unit = verdict(found), _counted(found), "error, first over second"
        value, against = (median(one.ratio for one in found) if found else None), 1.0
    elif rule.kind == "trial":
        tried = laser(spoofed)
        decided, text, unit = tried.verdict, tried.text, tried.unit
        value, against, sensors = tried.value, tried.against, tried.sensors
    else:
        decided, text, unit = NOT_TRIED, f"Not tried: {rule.rule}.", ""
    return {
        "id": rule.id,
        "specific": rule.specific,
        "question": rule.question,
        "kind": rule.kind,
        "verdict": decided,
        "text": text,
        "rule": "" if rule.kind == "untried" else rule.text,
        "value": value,
        "against": against,
        "unit": unit,
        "duels": [
            {
                "dataset": one.dataset,
                "first": " + ".join(one.first),
                "second": " + ".join(one.second),
                "ratio": float(f"{one.ratio:.4g}"),
                "outcome": one.outcome,
            }
            for one in found
        ],
        "sensors": list(sensors),
        "experiment": rule.first if sensors else "",
    }


@cache
def _calculated(name: str) -> Calculation:
    return CALCULATIONS[name]()


def _counted(found: Sequence[Duel]) -> str:
    wins, losses, ties = (
        sum(one.outcome == name for one in found) for name in ("win", "loss", "tie")
    )
    if not found:
        return "No data set has both families on enough units."
    middle = median(one.ratio for one in found)
    return (
        f"Of {len(found)} data sets the first family errs less on {wins}, the second on {losses}; "
        f"{ties} do not tell them apart. The median ratio of errors is {middle:.3g}."
    )
