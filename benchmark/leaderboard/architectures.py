"""The best pipeline of each architecture: how far it is from its bound, and how sure that is.

An architecture is a detector with a mask; of its data sets the one counts whose best pipeline errs
least under the first condition. Two numbers say how sure that is. The standard error of the ratio
to the bound is what the test samples leave open; the errors on the other units of the sensor are
what another specimen does. A runner-up that either of them does not tell apart is a tie.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from benchmark.metrics.score import is_available
from registry.measured import Partly, finer_for

Board = Mapping[str, Any]
Row = Mapping[str, Any]

#: Standard errors within which two ratios to the bound are not told apart.
STANDARD_ERRORS = 2.0

#: Members that are those of the best pipeline's score.
_OF_SCORE = (
    *("dataset", "half_fov_deg", "extractor", "model", "studies", "rms_deg", "bound_deg"),
    *("over_bound", "over_bound_se", "bound_unit_deg", "over_bound_unit", "floor_deg"),
    *("availability", "unit_rms_deg"),
)
#: Members of a pipeline that errs far less on what it answers, named `finer_...`.
_OF_FINER = ("dataset", "extractor", "model", "rms_deg", "over_bound", "availability")
#: Members of the runner-up, named `runner_up_...`.
_OF_RUNNER_UP = ("extractor", "model", "rms_deg", "over_bound", "over_bound_se", "unit_rms_deg")


def architectures(board: Board) -> list[dict[str, Any]]:
    """Choose the best pipeline of each architecture under the first condition of its data sets.

    Parameters
    ----------
    board
        As `benchmark.leaderboard.board.build` gives it.

    Returns
    -------
    list of dict
        By detector and mask: ``detector``, ``mask``, ``datasets`` (those compared), the best
        pipeline's ``dataset``, names, ``studies`` that used it, ``half_fov_deg`` and score on the
        standard unit (null where nothing has an error); ``others_low_deg`` and
        ``others_high_deg``, its smallest and largest error on the other units (null where one of
        them gives none); the pipeline that ranks next on the same data set as ``runner_up_...``;
        ``tie`` and what it is by: ``tie_by_samples`` (the ratios to the bound differ by less than
        `STANDARD_ERRORS` of their difference, taken as independent though they see the same
        samples), ``tie_by_units`` (the errors on the units overlap, as shared ranks do); on
        how many of ``units_compared`` units the best errs less, ``units_ahead``; and as
        ``finer_...`` the pipeline that errs least of those that answer half of the samples or more
        but too seldom to rank first, where the best errs far more (`registry.measured.finer_for`).
    """
    by: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    for dataset in board["datasets"]:
        by.setdefault((dataset["detector"], dataset["mask"]), []).append(dataset)
    return [
        {
            "detector": detector,
            "mask": mask,
            "datasets": [dataset["name"] for dataset in datasets],
            **_best(datasets),
        }
        for (detector, mask), datasets in sorted(by.items())
    ]


def first_boards(board: Board) -> Iterator[tuple[Mapping[str, Any], list[Row]]]:
    """Give each data set with the rows of its first condition."""
    for dataset in board["datasets"]:
        first = dataset["conditions"][0]
        yield dataset, [row for row in dataset["rows"] if row["condition"] == first]


def _best(datasets: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    ranked = [
        # Shared ranks stay in the order of the standard unit's errors.
        sorted((row for row in rows if row["rank"] is not None), key=_order)
        for _, rows in first_boards({"datasets": datasets})
    ]
    leading = min((rows for rows in ranked if rows), key=lambda rows: _order(rows[0]), default=[])
    best: Row = leading[0] if leading else {}
    next_one: Row = leading[1] if len(leading) > 1 else {}
    finer = _finer(best, ranked) if best and is_available(best) else {}
    others = (best.get("unit_rms_deg") or [])[1:]
    known = bool(others) and None not in others
    return {
        **{name: best.get(name) for name in _OF_SCORE},
        "studies": list(best.get("studies", ())),
        "others_low_deg": min(others) if known else None,
        "others_high_deg": max(others) if known else None,
        **{f"runner_up_{name}": next_one.get(name) for name in _OF_RUNNER_UP},
        **_tie(best, next_one),
        **{f"finer_{name}": finer.get(name) for name in _OF_FINER},
    }


def _finer(best: Row, ranked: Sequence[Sequence[Row]]) -> Row:
    """Return what errs far less than the best, answering seldom; nothing where nothing does."""
    seldom = (
        Partly(row["rms_deg"], row["availability"] or 0.0, row)
        for rows in ranked
        for row in rows
        if not is_available(row)
    )
    found = finer_for(best["rms_deg"], seldom)
    return {} if found is None else found.of


def _order(row: Row) -> tuple[bool, float, str, str]:
    return not is_available(row), row["rms_deg"], row["extractor"], row["model"]


def _tie(best: Row, runner_up: Row) -> dict[str, Any]:
    """Say what does not tell the runner-up from the best."""
    if not runner_up or is_available(best) != is_available(runner_up):
        found = {"tie_by_samples": False, "tie_by_units": False}
    else:
        found = {
            "tie_by_samples": _within(best, runner_up),
            "tie_by_units": best["rank"] == runner_up["rank"],
        }
    pairs = [
        (one, other)
        for one, other in zip(
            best.get("unit_rms_deg") or [], runner_up.get("unit_rms_deg") or [], strict=False
        )
        if one is not None and other is not None
    ]
    return {
        "tie": any(found.values()),
        **found,
        "units_ahead": sum(one < other for one, other in pairs) if pairs else None,
        "units_compared": len(pairs),
    }


def _within(best: Row, runner_up: Row) -> bool:
    ratios = best["over_bound"], runner_up["over_bound"]
    errors = best["over_bound_se"], runner_up["over_bound_se"]
    if None in ratios or None in errors:
        return False
    return bool(abs(ratios[1] - ratios[0]) <= STANDARD_ERRORS * math.hypot(*errors))
