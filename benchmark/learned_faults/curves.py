"""Curves over the strength of a fault, pooled over units, and who errs less where."""

from __future__ import annotations

import math
from collections.abc import Mapping
from statistics import median
from typing import Any

from benchmark.metrics.score import is_available

Row = Mapping[str, Any]

#: An error that does not count, as it is answered too seldom, is as large as can be.
NONE_DEG = 180.0


def curve(row: Row, way: str, member: str) -> list[float | None]:
    """Return a member of a way by strength.

    Shares of all units' frames of what is counted; of errors the median over units, None where a
    unit has none.
    """
    return [
        _middle(units) if member.endswith("_deg") else sum(units) / (row["frames"] * len(units))
        for units in row["ways"][way][member]
    ]


def _middle(units: list[float | None]) -> float | None:
    known = [error for error in units if error is not None]
    return median(known) if len(known) == len(units) else None


def logs(row: Row, at: int) -> list[float]:
    """Return logarithms of the network's error over the pipeline's at a strength, one a unit."""
    errors = [_errors(row, way, at) for way in ("network", "classical")]
    return [math.log(one / other) for one, other in zip(*errors, strict=True)]


def _errors(row: Row, way: str, at: int) -> list[float]:
    of = row["ways"][way]
    return [
        error if is_available({"availability": answered / row["frames"]}) else NONE_DEG
        for error, answered in zip(of["rms_deg"][at], of["answered"][at], strict=True)
    ]
