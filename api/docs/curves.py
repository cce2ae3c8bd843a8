"""Generated parts of the page on learning curves: poses needed, floors, a picture."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from api.docs.markdown import table
from benchmark.learning_curves import record

Row = Mapping[str, Any]


def poses_needed() -> str:
    """List the first leader of each data set: poses it needs, its floor, poses there are."""
    first: dict[str, Row] = {}
    for row in _rows():
        first.setdefault(row["dataset"], row)
    rows = [
        (
            f"[{row['dataset']}](datasets.md#{row['dataset']})",
            f"{row['extractor']} + {row['model']}",
            _poses(row["needed_poses"]),
            f"{_poses(row['needed_low'])} to {_poses(row['needed_high'])}",
            _poses(row["error_poses"]),
            _poses(row["answers_poses"]),
            str(row["poses"]),
            _floor(row),
            _number(row["over_bound"]),
        )
        for row in first.values()
    ]
    header = (
        *("data set", "pipeline", "poses within 10 %", "of the draws", "by error", "by answers"),
        *("poses given", "floor (deg)", "times bound"),
    )
    return table(header, rows)


def counts() -> str:
    """Say in numbers how many leaders need how many poses."""
    rows = _rows()
    lawful = [row for row in rows if not row["in_order"]]
    within = {
        most: sum((row["needed_poses"] or most + 1) <= most for row in lawful)
        for most in (25, 50, 100, 200)
    }
    said = ", ".join(f"{count} with {most} poses" for most, count in within.items())
    error = {
        most: sum((row["error_poses"] or most + 1) <= most for row in lawful) for most in within
    }
    alone = ", ".join(f"{count} with {most}" for most, count in error.items())
    fitted = sum(row["floor"] == "fitted" for row in rows)
    refused = sum(row["points"][0]["refused"] > 0 for row in rows)
    return (
        f"Of {len(lawful)} leaders that are calibrated on a bench, half of the draws come within "
        f"10 % of the floor and answer 95 % of the test split: {said}. Without the condition "
        f"on answers: {alone}. "
        f"{refused} of {len(rows)} refuse the smallest subset in some draw. The floor is the "
        f"fitted law's for {fitted}, the error with all poses for "
        f"{sum(row['floor'] == 'all' for row in rows)}."
    )


def leaders_short_of_poses() -> str:
    """List the leaders of which some draw does not come near with all poses there are."""
    rows = [
        (
            f"`{row['dataset']}`",
            f"{row['extractor']} + {row['model']}",
            f"{row['draws'] - row['reached']} of {row['draws']}",
            str(row["poses"]),
            " and ".join(_number(error) for error in row["all_deg"]),
            _floor(row),
        )
        for row in _rows()
        if row["reached"] < row["draws"]
    ]
    if not rows:
        return "Every leader comes within 10 % of its floor with the poses that are given."
    header = (
        *("data set", "pipeline", "draws that do not reach it", "poses given"),
        *("error with all, by unit (deg)", "floor (deg)"),
    )
    return table(header, rows)


@cache
def _rows() -> list[dict[str, Any]]:
    return record.published_curves()


def _poses(number: int | None) -> str:
    return "more" if number is None else str(number)


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}"


def _floor(row: Row) -> str:
    if row["floor"] == "none":
        return "none"
    if row["floor"] == "all":
        return f"{_number(row['floor_error_deg'])} (all poses)"
    low, high = _number(row["floor_low_deg"]), _number(row["floor_high_deg"])
    return f"{_number(row['floor_error_deg'])} ({low} to {high})"
