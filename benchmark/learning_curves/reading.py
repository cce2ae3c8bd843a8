"""Rows of learning curves as they are shown; needs nothing of what measured them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmark.metrics.separation import store
from files.strict_json import refuse_unless, require_members, require_type

#: A row of the record: plain JSON values.
Row = dict[str, Any]

#: What a point of a curve says.
POINT = ("poses", "middle_deg", "least_deg", "largest_deg", "availability", "refused")

_ANGLE = (int, float, type(None))
#: What a row holds, and of which type.
_MEMBERS: Mapping[str, type | tuple[type, ...]] = {
    **dict.fromkeys(("dataset", "condition", "extractor", "model"), str),
    **dict.fromkeys(("floor", "refusal", "key"), str),
    **dict.fromkeys(("place", "poses"), int),
    "in_order": bool,
    **dict.fromkeys(("floor_error_deg", "floor_low_deg", "floor_high_deg"), _ANGLE),
    **dict.fromkeys(("exponent", "misfit", "bound_deg", "bench_deg"), _ANGLE),
    **dict.fromkeys(("all_deg", "needed", "error_from", "answers_from", "points"), list),
}


def require_row(path: Path, row: object) -> None:
    """Raise FileRefusedError, naming the curve, for what is no row of the record."""
    held: Row = require_members(row, path, _MEMBERS)
    named = f"{held['dataset']}, place {held['place']}"
    for name, value in held.items():
        kind = (int, type(None)) if name in _FROM else _ANGLE
        if name == "points":
            for point in value:
                where = f"{named}, points"
                require_type(point, list, path, where)
                refuse_unless(
                    len(point) == len(POINT), path, f"{where}: expected {len(POINT)} each"
                )
                _require_sizes(path, where, point, _ANGLE)
        elif isinstance(value, list):
            _require_sizes(path, f"{named}, {name}", value, kind)
        elif isinstance(value, int | float):
            _require_sizes(path, f"{named}, {name}", [value], (*_ANGLE, bool))
    lengths = {len(held[name]) for name in _FROM}
    one_length = len(lengths) == 1 and 0 not in lengths
    refuse_unless(one_length, path, f"{named}: {', '.join(_FROM)} are empty or of other lengths")


#: Lists of numbers of poses, by draw.
_FROM = ("needed", "error_from", "answers_from")


def _require_sizes(
    path: Path, where: str, values: Sequence[object], kind: tuple[type, ...]
) -> None:
    for value in values:
        require_type(value, kind, path, where)
        least = f"{where}: expected a number of at least 0, got {value}"
        refuse_unless(not (isinstance(value, int | float) and value < 0), path, least)


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
    """Return the smallest value that half of them do not exceed; None stands above all.

    Raises
    ------
    ValueError
        Where there are none.
    """
    if not values:
        raise ValueError("values must not be empty")
    known = sorted(value for value in values if value is not None)
    middle = math.ceil(len(values) / 2) - 1
    return known[middle] if middle < len(known) else None
