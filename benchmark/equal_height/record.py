"""The published comparison at equal height: a table with a row a design."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from pydantic import BaseModel

from benchmark.results.csv_tables import Reader, above_zero, count, word
from benchmark.results.row_file import Row, TableFile
from benchmark.results.store import PUBLISHED

COLUMNS: Mapping[str, Reader] = {
    "design": word,
    "mask": word,
    "height_mm": above_zero,
    "half_fov_deg": above_zero,
    "units": count,
    "extractor": str,
    "model": str,
    "own_error_deg": above_zero,
    "own_low_deg": above_zero,
    "own_high_deg": above_zero,
    "flight_error_deg": above_zero,
    "flight_low_deg": above_zero,
    "flight_high_deg": above_zero,
    "bound_deg": above_zero,
    "reason": str,
}


class SharedFacts(BaseModel, extra="forbid"):
    """What a row was measured with."""

    key: str


def _design(row: Row) -> str:
    return str(row["design"])


RECORD = TableFile("equal_height.csv", COLUMNS, SharedFacts, _design, _design, _design)


def equal_rows(directory: Path | str = PUBLISHED) -> list[Row]:
    """Return the stored rows by error in flight, those without one last; without digests."""
    rows = [
        {name: value for name, value in row.items() if name != "key"}
        for row in RECORD.read(directory).values()
    ]
    return by_flight(rows)


def by_flight(rows: list[Row]) -> list[Row]:
    """Order rows by error in flight, those without one last."""
    return sorted(
        rows, key=lambda row: (row["flight_error_deg"] is None, row["flight_error_deg"] or 0.0)
    )
