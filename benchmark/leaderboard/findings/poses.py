"""How many calibration poses are enough once the bench's own error is counted."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from benchmark.leaderboard.findings.finding import Estimate, Finding, number
from benchmark.learning_curves.floor import NEAR
from benchmark.metrics.score import AVAILABLE

Row = Mapping[str, Any]


def poses(curves: Iterable[Row]) -> Finding:
    """Count the poses from which on the best pipeline is near its floor, with and without bench."""
    first = [row for row in curves if row["place"] == 1]
    kept = [row for row in first if not row["in_order"]]
    pairs = [_pair(row) for row in kept]
    of = "data sets"
    own, bench, answers = (
        Estimate.median(name, [_or_more(pair[column]) for pair in pairs], of)
        for name, column in (
            ("poses for the error with true directions", "own_poses"),
            ("poses for the error on the standard bench", "bench_poses"),
            ("poses for 95 % of answers", "answer_poses"),
        )
    )
    return Finding(
        "poses",
        f"On a bench, {number(bench.value)} calibration poses are enough for the accuracy, and "
        f"{number(answers.value)} for the field.",
        f"From {number(bench.value)} random poses on (median of {bench.n} data sets; 95 % interval "
        f"{bench.interval}) the error of the best pipeline on the standard bench is within "
        f"{100 * (NEAR - 1):.0f} % of its floor; with true directions from {number(own.value)} on "
        f"({own.interval}). It answers {100 * AVAILABLE:.0f} % of the test split from "
        f"{number(answers.value)} on ({answers.interval}), because models answer only inside the "
        "hull of their poses; a planned grid may need fewer.",
        (own, bench, answers),
        (f"{len(first) - len(kept)} flights, which have no choice of poses",),
        tuple(pairs),
    )


def _pair(row: Row) -> dict[str, Any]:
    bench = row["bench_deg"]
    return {
        "dataset": row["dataset"],
        "extractor": row["extractor"],
        "model": row["model"],
        "floor_deg": row["floor_error_deg"],
        "bench_deg": bench,
        "poses_given": row["poses"],
        "own_poses": _from(row, lambda point: _is_near(point, row["floor_error_deg"], 0.0)),
        "bench_poses": _from(row, lambda point: _is_near(point, row["floor_error_deg"], bench)),
        "answer_poses": _from(row, _answers),
    }


def _from(row: Row, meets: Callable[[Row], bool]) -> int | None:
    """Return the smallest number of poses from which on every point meets a condition."""
    found: int | None = None
    for point in reversed(row["points"]):
        if point["refused"] or not meets(point):
            break
        found = point["poses"]
    return found


def _is_near(point: Row, floor_deg: float | None, bench_deg: float) -> bool:
    if floor_deg is None or point["middle_deg"] is None:
        return False
    limit = NEAR * math.hypot(floor_deg, bench_deg)
    return math.hypot(point["middle_deg"], bench_deg) <= limit


def _answers(point: Row) -> bool:
    return bool(point["availability"] is not None and point["availability"] >= AVAILABLE)


def _or_more(count: int | None) -> float:
    return math.inf if count is None else float(count)
