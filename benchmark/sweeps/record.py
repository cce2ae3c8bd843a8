"""The published sweeps: a table with a row for each method at each point of a series."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from benchmark.results.csv_tables import Reader, count, number, one_of, share, size, word
from benchmark.results.row_file import Row, TableFile
from benchmark.results.store import PUBLISHED, STATUSES
from benchmark.sweeps.points import Point

#: Numbers of a row.
NUMBERS = (
    *("found_fraction", "kept_fraction", "wrong_fraction"),
    *("rms", "bias", "bound", "over_bound"),
)
_COLUMNS: Mapping[str, Reader] = {
    "series": str,
    "sweep": str,
    "point": str,
    "extractor": word,
    "status": one_of(*STATUSES),
    "value": number,
    "n": count,
    "unit": str,
    **dict.fromkeys(NUMBERS, size),
    **dict.fromkeys(("found_fraction", "kept_fraction", "wrong_fraction"), share),
    "bias": number,
    "reason": str,
}


class SharedFacts(BaseModel, extra="forbid"):
    """What the rows of a series and an extractor share."""

    extractor_taxonomy: str
    extractor_version: int
    key: str


def point_of(row: Mapping[str, Any]) -> Point:
    """Return the point that a row is of."""
    return Point(row["series"], row["sweep"], row["point"], row["extractor"])


def _group_of(row: Row) -> str:
    return f"{row['series']}/{row['extractor']}"


def _place_of(row: Row) -> tuple[Any, ...]:
    """Order rows by series, sweep and point as they are defined, then by extractor."""
    from benchmark.sweeps.plan import SERIES  # noqa: PLC0415 - readers need no simulator
    from benchmark.synthetic_features.series import SWEEPS  # noqa: PLC0415

    series, sweeps, value = [*SERIES, ""], [*SWEEPS, ""], row["value"]
    return (
        series.index(row["series"]) if row["series"] in series else len(series),
        sweeps.index(row["sweep"]) if row["sweep"] in sweeps else len(sweeps),
        math.inf if value is None else value,
        point_of(row),
    )


RECORD = TableFile("sweeps.csv", _COLUMNS, SharedFacts, point_of, _group_of, _place_of)


def swept(directory: Path | str = PUBLISHED) -> list[Row]:
    """Return stored rows in order, without digests; StoreError for a line that is none."""
    return [
        {name: value for name, value in row.items() if name != "key"}
        for row in RECORD.read(directory).values()
    ]
