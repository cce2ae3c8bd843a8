"""The best pipeline of each architecture: how far it is from its bound, and how sure that is.

An architecture is a detector with a mask; of its data sets the one counts whose best pipeline errs
least under the first condition. What is chosen on some units is quoted on others: the best of many
is partly the luckiest. A runner-up that the paired test of the board does not tell apart is a tie.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from benchmark.contract import FLIGHT
from benchmark.leaderboard.partial_answers import PartialAnswer, better_partial_answer
from benchmark.metrics.ranking import UnitErrors, luck_of_standard
from benchmark.metrics.score import is_available
from benchmark.metrics.separation import store
from registry.height_order import HeightOrder, at_reference, height_order

Board = Mapping[str, Any]
Row = Mapping[str, Any]

#: Members that are those of the best pipeline's score.
_OF_SCORE = (
    *("dataset", "half_fov_deg", "extractor", "model", "studies", "rms_deg", "bound_deg"),
    *("own_error_deg", "own_se", "on_bench_deg", "on_bench_basis", "over_bound", "over_bound_se"),
    *("bound_unit_deg", "over_bound_unit", "availability", "unit_rms_deg"),
)
#: Members of a pipeline that errs far less on what it answers, named `partial_...`.
_OF_FINER = ("dataset", "extractor", "model", "own_error_deg", "over_bound", "availability")
#: Members of the runner-up, named `runner_up_...`.
_OF_RUNNER_UP = ("extractor", "model", "own_error_deg", "unit_rms_deg")


def architectures(board: Board) -> list[dict[str, Any]]:
    """Choose the best pipeline of each architecture under the first condition of its data sets.

    Parameters
    ----------
    board
        As `benchmark.leaderboard.board.build` gives it.

    Returns
    -------
    list of dict
        By detector and mask: ``detector``, ``mask``, ``datasets`` (those compared), the
        best pipeline's ``dataset``, names, ``studies`` that used it, ``half_fov_deg``,
        ``own_error_deg`` with its relative standard error ``own_se``, its error on a bench,
        and its score on the standard unit (null where nothing has an error);
        ``flight_error_deg`` with ``flight_low_deg`` and ``flight_high_deg``, the same pipeline's
        error in flight and its range over units (null where it was not flown);
        ``height_mm`` of mask or lens over the detector, and both errors scaled to a height of 1 mm,
        ``own_at_1_mm_deg`` and ``flight_at_1_mm_deg`` (null for sensors without a height);
        ``quoted_deg``, the error on the odd units of what errs least on the even ones, data
        set and pipeline; ``others_low_deg`` and ``others_high_deg``, its smallest and
        largest error on the units other than the standard one (null where one of them gives
        none); the pipeline that ranks next on the same data set, twins aside, as
        ``runner_up_...``; ``tie`` (whether the board does not tell it apart) and
        ``first_group`` (how many it does not); on how many of ``units_compared`` units the
        best errs less, ``units_ahead``; and as ``partial_...`` the pipeline that errs least
        of those that answer half of the samples or more but too seldom to rank first, where
        the best errs far more
        (`benchmark.leaderboard.partial_answers.better_partial_answer`).
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


def order_of_heights(rows: Sequence[Row]) -> HeightOrder | None:
    """Return how far errors in flight of `architectures` follow 1/height."""
    return height_order((row["flight_error_deg"], row["height_mm"]) for row in rows)


def first_boards(board: Board) -> Iterator[tuple[Mapping[str, Any], list[Row]]]:
    """Give each data set with the rows of its first condition."""
    for dataset in board["datasets"]:
        first = dataset["conditions"][0]
        yield dataset, [row for row in dataset["rows"] if row["condition"] == first]


def _best(datasets: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    ranked = [
        sorted((row for row in rows if row["rank"] is not None and not row["twin_of"]), key=_order)
        for _, rows in first_boards({"datasets": datasets})
    ]
    leading = min((rows for rows in ranked if rows), key=lambda rows: _order(rows[0]), default=[])
    best: Row = leading[0] if leading else {}
    next_one: Row = leading[1] if len(leading) > 1 else {}
    finer = _finer(best, ranked) if best and is_available(best) else {}
    flown = _in_flight(best, datasets)
    height = next(
        (one["height_mm"] for one in datasets if one["name"] == best.get("dataset")), None
    )
    others = (best.get("unit_rms_deg") or [])[1:]
    known = bool(others) and None not in others
    return {
        **{name: best.get(name) for name in _OF_SCORE},
        **flown,
        "height_mm": height,
        "own_at_1_mm_deg": _stored(at_reference(best.get("own_error_deg"), height)),
        "flight_at_1_mm_deg": _stored(at_reference(flown["flight_error_deg"], height)),
        "studies": list(best.get("studies", ())),
        "quoted_deg": _quote(ranked),
        "others_low_deg": min(others) if known else None,
        "others_high_deg": max(others) if known else None,
        **{f"runner_up_{name}": next_one.get(name) for name in _OF_RUNNER_UP},
        "first_group": sum(row["group"] == 1 for row in leading),
        **_tie(best, next_one),
        **{f"partial_{name}": finer.get(name) for name in _OF_FINER},
    }


def _stored(error_deg: float | None) -> float | None:
    return None if error_deg is None else store(error_deg)


def _in_flight(best: Row, datasets: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the error in flight of the best pipeline; of a data set in orbit its own."""
    rows: list[Row] = []
    for dataset in datasets:
        if dataset["name"] == best.get("dataset"):
            condition = dataset["conditions"][0] if dataset["in_orbit"] else FLIGHT
            rows = [row for row in dataset["rows"] if row["condition"] == condition]
    names = best.get("extractor"), best.get("model")
    flown: Row = next((row for row in rows if (row["extractor"], row["model"]) == names), {})
    error = flown.get("own_error_deg")
    if error and len(flown["unit_rms_deg"]) == 1:
        luck = luck_of_standard(UnitErrors(tuple(row["unit_rms_deg"])) for row in rows)
        error = store(error * luck)
    return {
        "flight_error_deg": error,
        "flight_low_deg": flown.get("low_deg"),
        "flight_high_deg": flown.get("high_deg"),
    }


def _quote(ranked: Sequence[Sequence[Row]]) -> float | None:
    """Return the error on the odd units of what errs least on the even ones; None for one unit."""
    candidates = [
        (even.own_error_deg, odd.own_error_deg)
        for rows in ranked
        for row in rows
        if row["group"] is not None and is_available(row)
        for even, odd in [
            (
                UnitErrors(tuple(row["unit_rms_deg"][::2])),
                UnitErrors(tuple(row["unit_rms_deg"][1::2])),
            )
        ]
        if even.own_error_deg is not None and odd.own_error_deg is not None
    ]
    return min(candidates)[1] if candidates else None


def _finer(best: Row, ranked: Sequence[Sequence[Row]]) -> Row:
    """Return what errs far less than the best, answering seldom; nothing where nothing does."""
    seldom = (
        PartialAnswer(row["own_error_deg"], row["availability"] or 0.0, row)
        for rows in ranked
        for row in rows
        if not is_available(row)
    )
    found = better_partial_answer(best["own_error_deg"], seldom)
    return {} if found is None else found.subject


def _order(row: Row) -> tuple[bool, bool, float, str, str]:
    alone = row["group"] is None
    return not is_available(row), alone, row["own_error_deg"], row["extractor"], row["model"]


def _tie(best: Row, runner_up: Row) -> dict[str, Any]:
    """Whether the runner-up is distinguished from the best, and on how many units it errs more."""
    pairs = [
        (one, other)
        for one, other in zip(
            best.get("unit_rms_deg") or [], runner_up.get("unit_rms_deg") or [], strict=False
        )
        if one is not None and other is not None
    ]
    group = best.get("group")
    return {
        "tie": group is not None and group == runner_up.get("group"),
        "units_ahead": sum(one < other for one, other in pairs) if pairs else None,
        "units_compared": len(pairs),
    }
