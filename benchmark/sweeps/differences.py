"""Rows of sweeps beside rows measured again."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from benchmark.results.csv_tables import Row
from benchmark.sweeps.record import NUMBERS, point_of

#: As `benchmark.leaderboard.check.RELATIVE_TOLERANCE`, and of samples at the edge of being found.
RELATIVE_TOLERANCE = 1e-4
_SAMPLES_TOLERANCE = 1.5


def differences(committed: Sequence[Row], measured: Sequence[Row]) -> Iterator[tuple[str, ...]]:
    """Yield (point/column, committed, measured) where numbers differ by more than the tolerance."""
    there = {point_of(row): row for row in committed}
    for row in measured:
        point = point_of(row)
        known = there.get(point)
        if known is None:
            yield f"{point}/row", "absent", "measured"
            continue
        for column, value in row.items():
            if not _close(column, known.get(column), value, row):
                yield f"{point}/{column}", str(known.get(column)), str(value)


def _close(column: str, one: Any, other: Any, row: Row) -> bool:
    if column not in NUMBERS or one is None or other is None or one == other:
        return bool(one == other)
    if column.endswith("_fraction"):
        allowed = _SAMPLES_TOLERANCE / row["n"]
    elif column == "bias":  # a mean near zero is as uncertain as the spread it averages
        allowed = RELATIVE_TOLERANCE * (row["rms"] or 0.0)
    else:
        allowed = RELATIVE_TOLERANCE * abs(other)
    return math.isclose(one, other, rel_tol=0.0, abs_tol=allowed)
