"""A heat map of pipelines by condition: a table whose cells are shaded by how far they err."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Row = Mapping[str, Any]

STEPS = 8
"""Shades of a cell, in the style sheet; the highest is the largest error."""


@dataclass(frozen=True)
class Cell:
    """What a pipeline does under a condition.

    Attributes
    ----------
    rms_all_answers_deg : RMS of unit 0 over all answers; None without an error
    shade : 0 to `STEPS` - 1; None without an error
    status : of the score; None where there is none
    """

    rms_all_answers_deg: float | None
    shade: int | None
    status: str | None


@dataclass(frozen=True)
class HeatMap:
    """Errors of the best pipelines under every condition.

    Attributes
    ----------
    conditions : one a column
    rows : (extractor, model, cells)
    minimum, maximum : ends of the shades, in degrees
    """

    conditions: Sequence[str]
    rows: Sequence[tuple[str, str, Sequence[Cell]]]
    minimum: float
    maximum: float


def heat_map(board: Sequence[Row], conditions: Sequence[str], ranked_by: str, most: int) -> HeatMap:
    """Return the map of the first pipelines of one condition's board.

    Parameters
    ----------
    board : rows of every condition
    conditions : of the data set, in order
    ranked_by : the condition whose order chooses the pipelines
    most : how many
    """
    chosen = [(r["extractor"], r["model"]) for r in board if r["condition"] == ranked_by][:most]
    scores = {(r["extractor"], r["model"], r["condition"]): r for r in board}
    errors = [
        row["rms_all_answers_deg"]
        for way in chosen
        for condition in conditions
        if (row := scores.get((*way, condition))) and row["rms_all_answers_deg"]
    ]
    low, high = min(errors, default=1.0), max(errors, default=1.0)
    width = math.log(high / low) or 1.0

    def cell(row: Row | None) -> Cell:
        error = row["rms_all_answers_deg"] if row else None
        if not row or not error:
            return Cell(None, None, row["status"] if row else None)
        shade = int(STEPS * math.log(error / low) / width)
        return Cell(error, min(shade, STEPS - 1), row["status"])

    rows = [
        (*way, [cell(scores.get((*way, condition))) for condition in conditions]) for way in chosen
    ]
    return HeatMap(conditions, rows, low, high)
