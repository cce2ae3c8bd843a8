"""Parts of pipelines by condition, pooled over data sets, and two of them against each other.

An extractor (or model) stands on a data set for its best pipeline under the first condition among
those that were tested under all conditions asked for: what is chosen before the condition comes is
judged under it. Errors are multiples of the bound, so that sensors of different size can be pooled;
a pipeline below 95 % availability counts as infinitely far from it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any, Literal

import numpy as np

from benchmark.leaderboard.architectures import first_boards
from benchmark.metrics.intervals import LEVEL, share_interval
from benchmark.metrics.paired import EQUIVALENT
from benchmark.metrics.score import is_available
from benchmark.seeds import generator

Row = Mapping[str, Any]
Role = Literal["extractor", "model"]
Outcome = Literal["win", "tie", "loss", "neither"]

#: Draws of the bootstrap over data sets.
DRAWS = 10_000
_PARTNER: Mapping[Role, str] = {"extractor": "model", "model": "extractor"}


@dataclass(frozen=True)
class Cell:
    """A part under one condition, or the worst of several, pooled over data sets.

    Attributes
    ----------
    over_bound
        Median over data sets of the multiple of the bound; infinite where half or more of them
        have no sufficient availability.
    over_best
        Median of the same over that of the best part on the same data set and condition.
    datasets
        Those where it was tested.
    answered
        On how many of them its availability is sufficient.
    """

    over_bound: float
    over_best: float
    datasets: tuple[str, ...]
    answered: int


@dataclass(frozen=True)
class Duel:
    """Two parts on one data set under one condition; multiples of the bound, infinite for none."""

    dataset: str
    condition: str
    first_over_bound: float
    second_over_bound: float

    @property
    def ratio(self) -> float:
        """First over second: below 1 the first has the smaller error; NaN where neither answers."""
        first, second = self.first_over_bound, self.second_over_bound
        return math.nan if math.isinf(first) and math.isinf(second) else first / second

    @property
    def outcome(self) -> Outcome:
        """For the first; a tie where the errors differ by at most 3 % (`paired.EQUIVALENT`)."""
        if math.isnan(self.ratio):
            return "neither"
        if 1 / EQUIVALENT <= self.ratio <= EQUIVALENT:
            return "tie"
        return "win" if self.ratio < 1 else "loss"


class Robustness:
    """Multiples of the bound of every extractor or model under every condition of every data set.

    Parameters
    ----------
    datasets
        Of a leaderboard (`benchmark.leaderboard.board.build`).
    role
        Which part.
    """

    def __init__(self, datasets: Sequence[Row], role: Role) -> None:
        self.role = role
        self.conditions_of = {one["name"]: tuple(one["conditions"]) for one in datasets}
        self._ways: dict[tuple[str, str], list[dict[str, float]]] = {}
        for dataset, board in first_boards({"datasets": datasets}):
            under: dict[tuple[str, str], dict[str, float]] = {}
            for row in dataset["rows"]:
                value = multiple(row)
                if value is not None:
                    under.setdefault(_pipeline(row), {})[row["condition"]] = value
            for row in sorted(board, key=lambda row: _order(row, role)):
                if way := under.get(_pipeline(row)):
                    self._ways.setdefault((dataset["name"], row[role]), []).append(way)
        self.parts = tuple(sorted({part for _, part in self._ways}))
        every = (c for one in self.conditions_of.values() for c in one)
        self.conditions = tuple(dict.fromkeys(every))

    def worst(self, dataset: str, part: str, conditions: Iterable[str]) -> float | None:
        """Return the largest multiple of a part under conditions; None where one is not tested."""
        asked = tuple(conditions)
        for way in self._ways.get((dataset, part), ()):
            if all(one in way for one in asked):
                return max(way[one] for one in asked)
        return None

    def pooled(self, conditions: Callable[[Sequence[str]], Sequence[str]]) -> dict[str, Cell]:
        """Pool the worst of conditions over data sets, by part.

        Parameters
        ----------
        conditions
            From those of a data set to those that are asked for; none where it lacks one, which
            leaves the data set out.
        """
        found: dict[str, dict[str, float]] = {}
        for dataset, there in self.conditions_of.items():
            if asked := conditions(there):
                for part in self.parts:
                    value = self.worst(dataset, part, asked)
                    if value is not None:
                        found.setdefault(dataset, {})[part] = value
        return {
            part: _pool({d: (of[part], min(of.values())) for d, of in found.items() if part in of})
            for part in self.parts
            if any(part in of for of in found.values())
        }

    def best(self, dataset: str, conditions: Iterable[str]) -> tuple[str, float] | None:
        """Return the part with the least worst multiple on a data set; None where none answers."""
        asked = tuple(conditions)
        worst = {part: self.worst(dataset, part, asked) for part in self.parts}
        known = [(v, part) for part, v in worst.items() if v is not None and math.isfinite(v)]
        return (min(known)[1], min(known)[0]) if known else None

    def duels(self, first: str, second: str, conditions: Iterable[str] = ()) -> list[Duel]:
        """Return two parts on every data set and condition (of some, if named) that both have."""
        asked = set(conditions)
        return [
            Duel(dataset, condition, one, other)
            for dataset, there in self.conditions_of.items()
            for condition in there
            if not asked or condition in asked
            for one in [self.worst(dataset, first, (condition,))]
            for other in [self.worst(dataset, second, (condition,))]
            if one is not None and other is not None
        ]


def multiple(row: Row) -> float | None:
    """Return the multiple of the bound of a score; None where a bound is not known.

    Infinite where nothing was answered, or less than 95 % of what can be.
    """
    if row["over_bound"] is None:
        return math.inf if row["rms_deg"] is None else None
    return float(row["over_bound"]) if is_available(row) else math.inf


def pairwise(duels: Sequence[Duel], *names: str) -> dict[str, Any]:
    """Count outcomes, and bound the share of wins and the median ratio.

    Parameters
    ----------
    duels
        Of `Robustness.duels`.
    names
        Of the random stream of the bootstrap, such as those of the two parts.

    Returns
    -------
    dict
        ``wins``, ``ties``, ``losses`` of the first, and ``neither``, boards on which neither has
        sufficient availability; ``data_sets``; ``share_low`` and ``share_high``, the interval of
        the share of wins among wins and losses by Clopper and Pearson, as if boards were
        independent (None without any); ``ratio``, the median of first over second, with
        ``ratio_low`` and ``ratio_high`` by a bootstrap over data sets: infinite where the second
        alone answers, None where there is nothing to compare.
    """
    outcomes = [one.outcome for one in duels]
    wins, losses = outcomes.count("win"), outcomes.count("loss")
    share = share_interval(wins, wins + losses) if wins + losses else (None, None)
    of: dict[str, list[float]] = {}
    for one in duels:
        if not math.isnan(one.ratio):
            of.setdefault(one.dataset, []).append(one.ratio)
    ends = _bootstrap(list(of.values()), *names) if of else (None, None)
    return {
        "wins": wins,
        "ties": outcomes.count("tie"),
        "losses": losses,
        "neither": outcomes.count("neither"),
        "data_sets": len({one.dataset for one in duels}),
        "share_low": share[0],
        "share_high": share[1],
        "ratio": median(ratio for ratios in of.values() for ratio in ratios) if of else None,
        "ratio_low": ends[0],
        "ratio_high": ends[1],
    }


def _bootstrap(ratios: Sequence[Sequence[float]], *names: str) -> tuple[float, float]:
    """Return the percentile interval of the median ratio; data sets are drawn with replacement.

    Boards of one data set share its sensor, so that they are drawn together.
    """
    values = np.array([ratio for of in ratios for ratio in of])
    owner = np.repeat(np.arange(len(ratios)), [len(of) for of in ratios])
    random = generator("robustness", "pairwise", *names)
    times = random.multinomial(len(ratios), np.full(len(ratios), 1 / len(ratios)), size=DRAWS)
    order = np.argsort(values)
    reached = np.cumsum(times[:, owner[order]], axis=1)  # ratios drawn, up to each
    total = reached[:, -1:]
    lower, upper = (
        values[order][(reached < at).sum(axis=1)] for at in ((total + 1) // 2, total // 2 + 1)
    )
    medians = (lower + upper) / 2
    tail = (1.0 - LEVEL) / 2.0
    found = np.quantile(medians, (tail, 1.0 - tail), method="inverted_cdf")
    return float(found[0]), float(found[1])


def _pool(values: Mapping[str, tuple[float, float]]) -> Cell:
    over_best = [
        value / best if math.isfinite(value) else math.inf for value, best in values.values()
    ]
    known = [value for value, _ in values.values()]
    return Cell(
        median(known), median(over_best), tuple(values), sum(math.isfinite(v) for v in known)
    )


def _order(row: Row, role: Role) -> tuple[bool, bool, float, str]:
    error = row["own_error_deg"]
    return error is None, not is_available(row), error or 0.0, row[_PARTNER[role]]


def _pipeline(row: Row) -> tuple[str, str]:
    return row["extractor"], row["model"]
