"""The published outcomes of masks: a row a data set."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ConfigDict, NonNegativeFloat, NonNegativeInt, create_model

from benchmark.results.row_file import RowFile

#: As `benchmark.segmentation.measure` has them; counts and errors of a method are by unit.
_FIELDS: dict[str, Any] = {
    **dict.fromkeys(("dataset", "leader", "model", "key"), str),
    "clean_error_deg": NonNegativeFloat,
    **dict.fromkeys(("units", "frames"), list[NonNegativeInt]),
    "faults": list[dict[str, Any]],
}
_REQUIRED: dict[str, Any] = {name: (kind, ...) for name, kind in _FIELDS.items()}
_ROW = create_model("Segmented", __config__=ConfigDict(extra="forbid"), **_REQUIRED)


def cell_of(row: Mapping[str, Any]) -> str:
    """Name a row: its data set."""
    return str(row["dataset"])


RECORD: RowFile[str] = RowFile("segmentation.json", "boards", 1, cell_of, _ROW)
