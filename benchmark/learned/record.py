"""The published outcomes of networks: a row a network and data set."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ConfigDict, NonNegativeFloat, NonNegativeInt, create_model

from benchmark.results.row_file import RowFile

#: `errors_deg` are by way of reading, one a unit; None where it answers too seldom. `validation` is
#: the error on units of validation: of heat maps in pixels, of SSCNN in degrees.
_FIELDS: dict[str, Any] = {
    **dict.fromkeys(("dataset", "network", "extractor", "model", "key"), str),
    "bound_deg": NonNegativeFloat,
    "errors_deg": dict[str, list[NonNegativeFloat | None]],
    "validation": list[NonNegativeFloat],
    **dict.fromkeys(("parameters", "frames"), NonNegativeInt),
    "times_slower": NonNegativeFloat,
    **dict.fromkeys(("trust", "ablation"), list[dict[str, Any]]),
}
_REQUIRED: dict[str, Any] = {name: (kind, ...) for name, kind in _FIELDS.items()}
_ROW = create_model("Learned", __config__=ConfigDict(extra="forbid"), **_REQUIRED)


def cell_of(row: Mapping[str, Any]) -> str:
    """Name a row: its network and data set."""
    return f"{row['network']}/{row['dataset']}"


RECORD: RowFile[str] = RowFile("learned.json", "networks", 1, cell_of, _ROW)
