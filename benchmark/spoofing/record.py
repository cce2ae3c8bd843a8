"""The published outcomes of lasers: a row a sensor and pipeline."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ConfigDict, NonNegativeFloat, NonNegativeInt, create_model

from benchmark.results.row_file import Row, RowFile

#: Counts are of readings, as `benchmark.spoofing.measure` has them.
_FIELDS: dict[str, Any] = {
    **dict.fromkeys(("dataset", "extractor", "model", "key"), str),
    "has_pattern": bool,
    **dict.fromkeys(("setting", "checking", "answered", "flagged"), NonNegativeInt),
    "own_error_deg": NonNegativeFloat,
    "knowable": NonNegativeFloat | None,
    "alarms": dict[str, NonNegativeInt],
    **dict.fromkeys(("levels", "rises"), list[dict[str, Any]]),
}
_REQUIRED: dict[str, Any] = {name: (kind, ...) for name, kind in _FIELDS.items()}
_ROW = create_model("Spoofed", __config__=ConfigDict(extra="forbid"), **_REQUIRED)


def cell_of(row: Mapping[str, Any]) -> str:
    """Name a row: its data set, and the extractor where it is not the leader."""
    return f"{row['dataset']}/{row['extractor']}"


RECORD: RowFile[str] = RowFile("spoofing.json", "sensors", 1, cell_of, _ROW)


def level_of(row: Mapping[str, Any], suns: float, *, sun: bool = True) -> Row:
    """Return what came of a laser of so many Suns beside the Sun, or alone."""
    return next(one for one in row["levels"] if (one["suns"], one["sun"]) == (suns, sun))
