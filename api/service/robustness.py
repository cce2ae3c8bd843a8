"""Robustness: extractors or models by condition, and two of them against each other."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache, partial
from itertools import chain
from typing import Any

from api.figures.robustness import WORST, robustness_figure
from api.schema.measured_figures import Robustness, RobustnessQuery
from api.service.documents import Document
from api.service.figures import measured_document
from api.service.knowledge import Knowledge
from api.service.problems import Problem, Violation
from benchmark.datasets.hazards import TRIED, hazards
from benchmark.leaderboard import robustness as measured
from survey_data.nearest import nearest_name

#: Condition of the record -> hazards that act in it at once.
TOGETHER: Mapping[str, frozenset[str]] = {
    "flight": frozenset({"albedo", "ageing", "misalignment", "temperature"}),
    "saturation-clouds": frozenset({"saturation", "glare"}),
}

_FIRST = "nominal"
_UNTESTED = measured.Cell(math.inf, math.inf, (), 0)


def robustness(known: Knowledge, query: RobustnessQuery) -> Document:
    """Return multiples of the bound by extractor or model and condition, pooled over data sets.

    A row stands on a data set for its best pipeline under the first condition among those tested
    under the condition. With `condition` or `hazard` the row `worst` is the worst of those asked
    for, over data sets that have all of them. `compare` counts wins, ties and losses of two rows.
    CSV: a row per cell.
    """
    table = _table(known, query.rows, (*query.detector,), (*query.mask,))
    asked = {name: _asked(there, query) for name, there in table.conditions_of.items()}
    named = {*query.condition, *(c for hazard in query.hazard for c in TRIED[hazard])}
    shown = {_FIRST, *named, *chain(*asked.values())} if named else {*table.conditions}
    cells = {c: table.pooled(partial(_one, c)) for c in table.conditions if c in shown}
    if named:
        cells[WORST] = table.pooled(partial(_asked, query=query))
    combined = cells.get(WORST, {})
    parts = [part for part in table.parts if part in combined] or list(table.parts)
    items = [
        _cell(part, condition, of.get(part, _UNTESTED))
        for part in _ordered(parts, cells)
        for condition, of in cells.items()
    ]
    pairwise, duels = _pairwise(table, query, named)
    best = [
        {"dataset": name, "name": found[0], "over_bound": _finite(found[1])}
        for name, conditions in asked.items()
        if conditions and (found := table.best(name, conditions))
    ]
    more: dict[str, Any] = {
        "best": best,
        "together": _together(query),
        "pairwise": pairwise,
        "duels": duels,
    }
    figure = robustness_figure(
        items,
        rows=query.rows,
        asked=[*query.hazard, *query.condition],
        datasets=[name for name, conditions in asked.items() if conditions],
        **more,
    )
    return measured_document(figure, Robustness, **more)


def _one(condition: str, there: Sequence[str]) -> tuple[str, ...]:
    return (condition,) if condition in there else ()


@lru_cache(32)
def _table(
    known: Knowledge, role: measured.Role, detector: tuple[str, ...], mask: tuple[str, ...]
) -> measured.Robustness:
    boards = [
        one
        for one in known.measurements.leaderboard["datasets"]
        if one["detector"] in (detector or (one["detector"],))
        and one["mask"] in (mask or (one["mask"],))
    ]
    return measured.Robustness(boards, role)


def _asked(there: Sequence[str], query: RobustnessQuery) -> tuple[str, ...]:
    """Return the conditions of a data set that are asked for; none where it lacks one."""
    tried = hazards(there)
    if any(h not in tried for h in query.hazard) or any(c not in there for c in query.condition):
        return ()
    named = (*query.condition, *(c for hazard in query.hazard for c in tried[hazard]))
    return tuple(dict.fromkeys(named))


def _ordered(parts: list[str], cells: Mapping[str, Mapping[str, measured.Cell]]) -> list[str]:
    """Return rows, those of the smallest error first.

    Of what is asked for by the error over the best of each data set; rows on less than half as many
    data sets as another has come last.
    """
    by = cells.get(WORST) or next(iter(cells.values()), {})
    most = max((len(cell.datasets) for cell in by.values()), default=0)

    def key(part: str) -> tuple[bool, float, str]:
        cell = by.get(part, _UNTESTED)
        few = 2 * len(cell.datasets) < most
        return few, cell.over_best if cells.get(WORST) else cell.over_bound, part

    return sorted(parts, key=key)


def _cell(part: str, condition: str, cell: measured.Cell) -> dict[str, Any]:
    state = "measured" if math.isfinite(cell.over_bound) else "below 95 %"
    return {
        "name": part,
        "condition": condition,
        "state": state if cell.datasets else "untested",
        "over_bound": _finite(cell.over_bound),
        "over_best": _finite(cell.over_best),
        "data_sets": len(cell.datasets),
        "answered": cell.answered,
        "datasets": list(cell.datasets),
    }


def _together(query: RobustnessQuery) -> list[str]:
    """Return conditions of the record in which everything that is asked for acts at once."""
    of = {c: hazard for hazard, conditions in TRIED.items() for c in conditions}
    wanted = {*query.hazard, *(of.get(c, c) for c in query.condition)}
    if len(wanted) <= 1:
        return []
    return [condition for condition, acting in TOGETHER.items() if wanted <= acting]


def _pairwise(
    table: measured.Robustness, query: RobustnessQuery, named: Collection[str]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    if not query.compare:
        return [], []
    for name in query.compare:
        if name not in table.parts:
            _refuse(name, f"a measured {query.rows}", nearest_name(name, table.parts))
    if len(query.compare) != 2:
        _refuse(", ".join(query.compare), "two different names, or none", None)
    first, second = query.compare
    duels = table.duels(first, second, named)
    scopes = {"all conditions": duels}
    if not named:
        nominal = table.conditions_of
        scopes["first condition"] = [d for d in duels if d.condition == nominal[d.dataset][0]]
    rows = [
        {
            "scope": scope,
            "first": first,
            "second": second,
            **{
                name: _finite(value) if isinstance(value, float) else value
                for name, value in measured.pairwise(some, first, second).items()
            },
        }
        for scope, some in scopes.items()
    ]
    return rows, [
        {
            "dataset": one.dataset,
            "condition": one.condition,
            "first_over_bound": _finite(one.first_over_bound),
            "second_over_bound": _finite(one.second_over_bound),
            "ratio": _finite(one.ratio) if one.ratio else None,
            "outcome": one.outcome,
        }
        for one in duels
    ]


def _refuse(value: str, expected: str, nearest: str | None) -> None:
    violation = Violation("compare", value, expected, nearest)
    raise Problem(422, "invalid-value", errors=[violation])


def _finite(value: float) -> float | None:
    return float(f"{value:.5g}") if math.isfinite(value) else None
