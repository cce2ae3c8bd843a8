"""The published error budgets: of each data set's leading score, with a digest of what it is of."""

from __future__ import annotations

from typing import Any

from pydantic import ConfigDict, NonNegativeFloat, NonNegativeInt, create_model

from benchmark.error_budget.variants import VARIANTS
from benchmark.results.row_file import Row, RowFile

#: Which score the row is of, as the record has it.
SCORE = ("condition", "extractor", "model", "rms_deg", "bound_deg", "bound_unit_deg")
_ANGLES = ("rms_deg", "bound_deg", "bound_unit_deg", *(f"{name}_deg" for name in VARIANTS))
_FIELDS: dict[str, Any] = {
    **dict.fromkeys(("dataset", "condition", "extractor", "model", "key"), str),
    **dict.fromkeys(("answered", "judged"), NonNegativeInt),
    **dict.fromkeys(_ANGLES, NonNegativeFloat | None),
}
_REQUIRED: dict[str, Any] = {name: (kind, ...) for name, kind in _FIELDS.items()}
_ROW = create_model("ErrorBudget", __config__=ConfigDict(extra="forbid"), **_REQUIRED)


def _dataset(row: Row) -> str:
    return str(row["dataset"])


RECORD = RowFile("error_budget.json", "budgets", 1, _dataset, _ROW)
