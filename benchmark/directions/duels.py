"""Directions that the record decides: two families of methods on the same data sets and units."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, Literal

import numpy as np
from scipy.special import stdtr

from benchmark import datasets
from benchmark.directions.rules import Rule, is_of
from benchmark.metrics.score import is_available

Row = Mapping[str, Any]
Outcome = Literal["win", "loss", "tie"]

#: Ratio up to which errors are alike, and chance that scatter of units looks like a difference.
ALIKE, CHANCE = 1.03, 0.05
#: Units on which a family's best must have been scored, half of them to choose it by.
FEWEST_UNITS = 6
#: Data sets that must tell two families apart.
FEWEST_TOLD = 2


@dataclass(frozen=True)
class Duel:
    """The best of two families on one data set.

    `ratio` is the first's error over the second's, geometric mean over the units that did not
    choose them; `first` and `second` are extractor and model.
    """

    dataset: str
    first: tuple[str, str]
    second: tuple[str, str]
    ratio: float
    outcome: Outcome


def duels(rule: Rule, rows: Iterable[Row]) -> list[Duel]:
    """Return what came of a rule on every data set that has both families.

    Parameters
    ----------
    rule
        Of kind ``duel``.
    rows
        Scores of all units (`Store.rows(unit=None)`), each data set under its first condition.
    """
    found = []
    ordered = sorted(rows, key=lambda row: str(row["dataset"]))
    for name, group in groupby(ordered, key=lambda row: str(row["dataset"])):
        preset = datasets.get(name)
        if not rule.is_on(preset):
            continue
        board = [row for row in group if row["condition"] == preset.conditions[0]]
        best = [_best(board, family) for family in rule.families]
        if best[0] is not None and best[1] is not None:
            found.append(_duel(name, best[0], best[1]))
    return found


def verdict(found: Sequence[Duel]) -> str:
    """Return what a rule says of its duels: pays, does not pay, depends on the data set, open."""
    wins = sum(one.outcome == "win" for one in found)
    losses = sum(one.outcome == "loss" for one in found)
    if wins + losses < FEWEST_TOLD:
        return "open"
    if wins >= 3 * losses:
        return "pays"
    return "does not pay" if losses >= 3 * wins else "depends on the data set"


_Best = tuple[tuple[str, str], dict[int, float]]


def _best(board: Sequence[Row], family: str) -> _Best | None:
    """Return the family's best pipeline by its even units, and its errors by unit.

    Of those scored on enough units; one below 95 % availability on a unit is none.
    """
    errors: dict[tuple[str, str], dict[int, float]] = {}
    for row in board:
        if is_of(family, row["extractor"], row["model"]):
            usable = is_available(row) and row["rms_all_answers_deg"]
            one = errors.setdefault((row["extractor"], row["model"]), {})
            one[row["unit"]] = math.log(row["rms_all_answers_deg"]) if usable else math.inf
    means = {
        pipeline: float(np.mean([error for unit, error in by.items() if unit % 2 == 0]))
        for pipeline, by in errors.items()
        if len(by) >= FEWEST_UNITS and all(map(math.isfinite, by.values()))
    }
    if not means:
        return None
    chosen = min(means, key=lambda pipeline: (means[pipeline], pipeline))
    return chosen, errors[chosen]


def _duel(dataset: str, one: _Best, other: _Best) -> Duel:
    units = sorted(unit for unit in one[1].keys() & other[1].keys() if unit % 2)
    return judge(dataset, one[0], other[0], [one[1][unit] - other[1][unit] for unit in units])


def judge(
    dataset: str, first: tuple[str, str], second: tuple[str, str], logs: Sequence[float]
) -> Duel:
    """Return what logarithms of the ratio of errors, one a unit, say of two pipelines."""
    mean = float(np.mean(logs))
    outcome: Outcome = "tie"
    if abs(mean) > math.log(ALIKE):
        scatter = float(np.std(logs, ddof=1)) / math.sqrt(len(logs))
        beyond = (abs(mean) - math.log(ALIKE)) / max(scatter, 1e-9)
        if float(stdtr(len(logs) - 1, -beyond)) < CHANCE / 2.0:
            outcome = "win" if mean < 0 else "loss"
    return Duel(dataset, first, second, math.exp(mean), outcome)
