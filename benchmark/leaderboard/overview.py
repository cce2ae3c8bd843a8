"""What each part of a pipeline is good for across data sets: how often it comes near the bound.

Errors of different sensors cannot be averaged; times the bound they can be counted. A part is
judged on each board by the best pipeline that it is in, so that no part pays for a poor partner.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Mapping
from typing import Any, Literal, get_args

from benchmark.leaderboard.architectures import first_boards
from benchmark.metrics.score import is_available
from benchmark.metrics.separation import store

Board = Mapping[str, Any]
Row = Mapping[str, Any]
Role = Literal["extractor", "compensation", "model"]

ROLES: tuple[Role, ...] = get_args(Role)
#: Times the bound within which a part counts as near it.
WITHIN = (1.5, 3.0, 10.0)

SAYS = (
    "A board is a data set under its first condition. A part is an extractor, a compensation or "
    "a model. On each board a part is judged by its best pipeline: the one nearest to the "
    "Cramer-Rao bound with at least 95 % availability. A chain such as optical + lut counts for "
    "each of its members. Within 1.5×, 3×, 10×: share of the part's boards on which the error of "
    "this pipeline is at most that many times the bound on the standard unit; a refused or "
    "unavailable pipeline counts as not within. The median is over the boards with a result. "
    "Parts run on different boards, and on some boards no pipeline is near the bound; the last "
    "column counts the part's boards on which any pipeline is within 10 times the bound."
)


def overview(board: Board) -> dict[str, Any]:
    """Count for each part of a pipeline on how many boards it comes near the bound.

    Parameters
    ----------
    board
        As `benchmark.leaderboard.board.build` gives it; only its ``datasets`` are looked at.

    Returns
    -------
    dict
        ``says`` (how it aggregates, in words), ``within`` (the limits), ``boards`` (how many
        there are, those without a bound left out) and ``parts``: each with ``role``, ``part`` and
        ``taxonomy``, ``boards`` (on how many it ran), ``answered`` (on how many it has a ratio),
        ``within_1_5``, ``within_3`` and ``within_10`` (numbers of boards), ``share_1_5``,
        ``share_3`` and ``share_10`` (of those it ran on), ``median_over_bound`` (null without a
        ratio), ``leads`` (on how many it is part of the pipeline in front) and ``reachable_10``
        (on how many any pipeline comes within 10). By role, then by shares from near to far.
    """
    taxonomy: dict[tuple[Role, str], str] = {}
    ratios: dict[tuple[Role, str], list[tuple[float | None, bool, bool]]] = {}
    count = 0
    for _, rows in first_boards(board):
        if all(row["over_bound"] is None for row in rows):
            continue
        count += 1
        best: dict[tuple[Role, str], float | None] = {}
        for row in rows:
            ratio = row["over_bound"] if is_available(row) else None
            for role, part, value in _parts(row):
                place = role, part
                taxonomy[place] = value or taxonomy.get(place, "")
                known = best.get(place)
                best[place] = min((r for r in (known, ratio) if r is not None), default=None)
        front = min(
            (row for row in rows if row["rank"] is not None),
            key=lambda row: (
                not is_available(row),
                row["rank"],
                row["own_error_deg"],
                row["extractor"],
            ),
            default=None,
        )
        leading = {(role, part) for role, part, _ in _parts(front)} if front else set()
        nearest = min((ratio for ratio in best.values() if ratio is not None), default=None)
        reachable = nearest is not None and nearest <= max(WITHIN)
        for place, found in best.items():
            ratios.setdefault(place, []).append((found, place in leading, reachable))
    parts = [_count(place, taxonomy[place], found) for place, found in ratios.items()]
    parts.sort(key=_order)
    return {"says": SAYS, "within": list(WITHIN), "boards": count, "parts": parts}


def suffix(limit: float) -> str:
    """Return what the members of a limit end in: ``1_5`` of 1.5."""
    return f"{limit:g}".replace(".", "_")


def _parts(row: Row) -> Iterator[tuple[Role, str, str]]:
    """Give role, name and taxonomy value of each part of a row's pipeline."""
    yield "extractor", row["extractor"], row["extractor_taxonomy"]
    *ahead, model = row["model"].split(" + ")
    for number, part in enumerate(ahead):
        # A chain has the taxonomy value of its first member.
        yield "compensation", part, row["model_taxonomy"] if number == 0 else ""
    yield "model", model, "" if ahead else row["model_taxonomy"]


def _count(
    place: tuple[Role, str], taxonomy: str, found: list[tuple[float | None, bool, bool]]
) -> dict[str, Any]:
    role, part = place
    ran = len(found)
    ratios = [ratio for ratio, _, _ in found if ratio is not None]
    near = {limit: sum(ratio <= limit for ratio in ratios) for limit in WITHIN}
    return {
        "role": role,
        "part": part,
        "taxonomy": taxonomy,
        "boards": ran,
        "answered": len(ratios),
        **{f"within_{suffix(limit)}": number for limit, number in near.items()},
        **{f"share_{suffix(limit)}": number / ran for limit, number in near.items()},
        "median_over_bound": store(statistics.median(ratios)) if ratios else None,
        "leads": sum(leads for _, leads, _ in found),
        "reachable_10": sum(reachable for _, _, reachable in found),
    }


def _order(part: Row) -> tuple[Any, ...]:
    shares = (-part[f"share_{suffix(limit)}"] for limit in reversed(WITHIN))
    return ROLES.index(part["role"]), *shares, -part["boards"], part["part"]
