"""The published outcomes of the network under faults: a row a fault."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ConfigDict, NonNegativeFloat, NonNegativeInt, create_model

from benchmark.results.row_file import RowFile

#: `ways` holds, by way of reading and member, a list a strength of numbers a unit.
_FIELDS: dict[str, Any] = {
    **dict.fromkeys(("dataset", "network", "fault", "extractor", "model", "key"), str),
    **dict.fromkeys(("frames", "parameters", "learned"), NonNegativeInt),
    "strengths": list[NonNegativeFloat],
    "ways": dict[str, dict[str, list[list[NonNegativeFloat | None]]]],
    "validation": dict[str, list[NonNegativeFloat]],
}
_REQUIRED: dict[str, Any] = {name: (kind, ...) for name, kind in _FIELDS.items()}
_ROW = create_model("LearnedFault", __config__=ConfigDict(extra="forbid"), **_REQUIRED)


def cell_of(row: Mapping[str, Any]) -> str:
    """Name a row: its fault."""
    return str(row["fault"])


RECORD: RowFile[str] = RowFile("learned_faults.json", "faults", 1, cell_of, _ROW)
