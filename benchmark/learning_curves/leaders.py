"""Which pipelines have a learning curve: the leaders of each board, by one rule.

Of the standard unit under a data set's first condition, of pipelines that answer often enough to
be ranked: the one with the smallest own error, then the best pipeline of each of the next other
models, until there are `LEADING`. A model that gives the same numbers as one before is no other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from benchmark.metrics.score import is_available

Row = Mapping[str, Any]

#: Pipelines of a board, each with another model.
LEADING = 3
#: Numbers that twins share.
_SHARED = ("rms_all_answers_deg", "median_deg", "max_deg", "availability")


@dataclass(frozen=True, order=True)
class Leader:
    """One pipeline of a data set's board that leads.

    `place` is that among the leaders of its data set, from 1.
    """

    dataset: str
    place: int
    condition: str
    extractor: str
    model: str

    def __str__(self) -> str:
        return f"{self.dataset}/{self.condition}/{self.extractor}/{self.model}"


def leaders(scores: Iterable[Row], conditions: Mapping[str, str]) -> list[Leader]:
    """Return the leaders of every data set, best first within each.

    Fewer than `LEADING` where there are no more models.
    """
    boards: dict[str, list[Row]] = {}
    for row in scores:
        if (
            row["condition"] == conditions.get(row["dataset"])
            and row["unit"] == 0
            and row["rms_all_answers_deg"] is not None
            and is_available(row)
        ):
            boards.setdefault(row["dataset"], []).append(row)
    found = []
    for name in sorted(boards):
        best: dict[str, Row] = {}
        for row in sorted(
            boards[name],
            key=lambda row: (row["rms_all_answers_deg"], row["extractor"], row["model"]),
        ):
            best.setdefault(row["model"], row)
        others = {tuple(row[name] for name in _SHARED): row for row in reversed(best.values())}
        apart = list(reversed(others.values()))
        for place, row in enumerate(apart[:LEADING], start=1):
            found.append(Leader(name, place, row["condition"], row["extractor"], row["model"]))
    return found
