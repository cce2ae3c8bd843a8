"""Boards as pages show them: places of an algorithm, errors over the field, best of each part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from api.figures.figure import Figure
from api.figures.lines import Line, line_figure
from api.service.knowledge import Knowledge
from benchmark.metrics.rings import RINGS

Row = Mapping[str, Any]

COLUMNS = (
    "dataset",
    "condition",
    "rank",
    "of",
    "partner",
    "own_error_deg",
    "bound_deg",
    "over_bound",
)
"""What a place tells."""
MOST_LINES = 5
PARTNERS = {"extractor": "model", "model": "extractor"}


def first_rows(known: Knowledge, dataset: str | None = None) -> list[Row]:
    """Return the rows of the boards under each data set's first condition."""
    first = {name: preset.conditions[0] for name, preset in known.measurements.presets.items()}
    rows = known.measurements.board_rows(dataset)
    return [row for row in rows if row["condition"] == first[row["dataset"]]]


def places_of(known: Knowledge, role: str, name: str) -> list[dict[str, Any]]:
    """Return the best place of an algorithm on every board that ranks it, best first.

    `of` is how many have a rank there, `partner` the model (or extractor) beside it.
    """
    rows = first_rows(known)
    ranked: dict[str, int] = {}
    best: dict[str, Row] = {}
    for row in rows:
        if row["rank"] is None:
            continue
        board = row["dataset"]
        ranked[board] = max(ranked.get(board, 0), row["rank"])
        if row[role] == name and (board not in best or row["rank"] < best[board]["rank"]):
            best[board] = row
    places = [
        {
            **row,
            "of": ranked[board],
            "partner": row[PARTNERS[role]],
            **{name: row[name] for name in ("extractor", "model")},
        }
        for board, row in best.items()
    ]
    return sorted(places, key=lambda place: (place["rank"], place["over_bound"] or 1e9))


def best_of(known: Knowledge) -> dict[str, dict[str, Any]]:
    """Return of every algorithm its best place in short: rank, data set, and on how many boards."""
    found: dict[str, dict[str, Any]] = {}
    boards: dict[str, set[str]] = {}
    for row in first_rows(known):
        if row["rank"] is None:
            continue
        for role in PARTNERS:
            name = row[role]
            boards.setdefault(name, set()).add(row["dataset"])
            if name not in found or row["rank"] < found[name]["rank"]:
                found[name] = {"rank": row["rank"], "dataset": row["dataset"]}
    return {name: {**place, "boards": len(boards[name])} for name, place in found.items()}


def field_line(row: Row, name: str) -> Line:
    """Return the error of a score by angle off the boresight, each ring at its middle."""
    points = [((r.inner_deg + r.outer_deg) / 2, row[r.column]) for r in RINGS]
    last = max((k for k, (_, y) in enumerate(points) if y is not None), default=-1)
    return Line(name, points[: last + 1])


def field_chart(rows: Sequence[Row], named: str = "dataset") -> Figure:
    """Return errors over the field of the first few rows, each called by one of its members."""
    lines = [field_line(row, str(row[named])) for row in rows[:MOST_LINES]]
    return line_figure(
        "field",
        "Error against the Sun's angle off the boresight",
        lines,
        "angle off the boresight, °",
        "Unit 0 RMS, °",
    )
