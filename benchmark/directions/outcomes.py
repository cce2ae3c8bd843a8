"""What came of every direction: its verdict by its rule, and the numbers that decide."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from statistics import median
from types import MappingProxyType
from typing import Any

from benchmark.directions.duels import Duel, duels, verdict
from benchmark.directions.learned import learned
from benchmark.directions.paper import CALCULATIONS, Calculation
from benchmark.directions.rules import NOT_TRIED, Rule, rules
from benchmark.directions.segmented import segmented
from benchmark.directions.trials import Trial, laser, not_tried
from benchmark.results.store import PUBLISHED
from benchmark.running.experiment import recorded_experiments

Row = Mapping[str, Any]


#: What decides by an experiment's rows, by its name.
TRIALS: Mapping[str, Callable[[Sequence[Row]], Trial]] = MappingProxyType(
    {"spoofing": laser, "learned": learned, "segmentation": segmented}
)
#: Experiments whose rows are told beside those of one that decides, by its name.
_BESIDE: Mapping[str, tuple[str, ...]] = MappingProxyType({"learned": ("learned_faults",)})


def read_trials(directory: Path | str = PUBLISHED) -> dict[str, list[Row]]:
    """Return the rows of every experiment that decides a direction, by its name."""
    kinds = recorded_experiments()
    return {
        name: [
            row
            for of in (name, *_BESIDE.get(name, ()))
            for row in kinds[of].record.read(directory).values()
        ]
        for name in TRIALS
    }


def outcomes(
    rows: Iterable[Row], tried: Mapping[str, Sequence[Row]] = MappingProxyType({})
) -> list[dict[str, Any]]:
    """Return the outcome of every rule, in order.

    Parameters
    ----------
    rows
        Scores of all units (`Store.rows(unit=None)`).
    tried
        Rows of experiments by name (`read_trials`).
    """
    scored = list(rows)
    return [_outcome(rule, scored, tried) for rule in rules().values()]


def _outcome(rule: Rule, rows: Sequence[Row], tried: Mapping[str, Sequence[Row]]) -> dict[str, Any]:
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
        trial = TRIALS.get(rule.first, not_tried)(tried.get(rule.first, ()))
        decided, text, unit = trial.verdict, trial.text, trial.unit
        value, against = trial.value, trial.against
        sensors, found = trial.sensors, list(trial.duels)
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
        "experiment": rule.first if rule.kind == "trial" else "",
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
