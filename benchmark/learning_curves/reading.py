"""Rows of learning curves as they are shown; needs nothing of what measured them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, Self

from pydantic import BaseModel, Field, NonNegativeFloat, NonNegativeInt, model_validator

from benchmark.metrics.separation import store

#: A row of the record: plain JSON values.
Row = dict[str, Any]

#: What a point of a curve says.
POINT = ("poses", "middle_deg", "least_deg", "largest_deg", "availability", "refused")

_Size = NonNegativeFloat | None
_Poses = Annotated[list[NonNegativeInt | None], Field(min_length=1)]


class CurveRow(BaseModel, extra="forbid"):
    """A row of the record; `needed`, `error_from`, `answers_from`: numbers of poses by draw."""

    dataset: str
    condition: str
    extractor: str
    model: str
    floor: str
    refusal: str
    key: str
    place: NonNegativeInt
    poses: NonNegativeInt
    in_order: bool
    floor_error_deg: _Size
    floor_low_deg: _Size
    floor_high_deg: _Size
    exponent: _Size
    misfit: _Size
    bound_deg: _Size
    bench_deg: _Size
    all_deg: list[_Size]
    needed: _Poses
    error_from: _Poses
    answers_from: _Poses
    points: list[Annotated[list[_Size], Field(min_length=len(POINT), max_length=len(POINT))]]

    @model_validator(mode="after")
    def _has_one_number_of_draws(self) -> Self:
        if not len(self.needed) == len(self.error_from) == len(self.answers_from):
            raise ValueError("needed, error_from and answers_from are of different lengths")
        return self


def summary(row: Row) -> Row:
    """Return a row as it is shown: poses as numbers of half of the draws, with their range.

    Adds ``over_bound`` (floor over bound), ``draws``, ``reached`` (draws that come near with the
    poses there are), ``needed_poses``, ``needed_low``, ``needed_high``, ``error_poses`` and
    ``answers_poses``: those by which half of the draws, the first and the last one come near. Null
    stands for more poses than there are. ``points`` become objects.
    """
    needed = row["needed"]
    known = [value for value in needed if value is not None]
    over = None
    if row["floor_error_deg"] is not None and row["bound_deg"]:
        over = store(row["floor_error_deg"] / row["bound_deg"])
    return {
        **row,
        "over_bound": over,
        "draws": len(needed),
        "reached": len(known),
        "needed_poses": half_of(needed),
        "needed_low": min(known, default=None),
        "needed_high": max(known) if len(known) == len(needed) else None,
        "error_poses": half_of(row["error_from"]),
        "answers_poses": half_of(row["answers_from"]),
        "points": [dict(zip(POINT, point, strict=True)) for point in row["points"]],
    }


def half_of(values: Sequence[int | None]) -> int | None:
    """Return the smallest value that half of them do not exceed; None stands above all."""
    if not values:
        raise ValueError("values must not be empty")
    known = sorted(value for value in values if value is not None)
    middle = math.ceil(len(values) / 2) - 1
    return known[middle] if middle < len(known) else None
