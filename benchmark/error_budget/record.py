"""The published error budgets: of each data set's leading score, with a digest of what it is of."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from benchmark.error_budget.variants import VARIANTS
from benchmark.results.row_file import Row, RowFile
from files.strict_json import members, require

#: Which score the row is of, as the record has it.
SCORE = ("condition", "extractor", "model", "rms_deg", "bound_deg", "bound_unit_deg")
_ANGLES = ("rms_deg", "bound_deg", "bound_unit_deg", *(f"{name}_deg" for name in VARIANTS))
_MEMBERS: Mapping[str, type | tuple[type, ...]] = {
    **dict.fromkeys(("dataset", "condition", "extractor", "model", "key"), str),
    **dict.fromkeys(("answered", "judged"), int),
    **dict.fromkeys(_ANGLES, (int, float, type(None))),
}


def _require_row(path: Path, row: object) -> None:
    held: Row = members(row, path, _MEMBERS)
    for name in ("answered", "judged", *_ANGLES):
        least = f"{name}: expected a number of at least 0, got {held[name]}"
        require(held[name] is None or held[name] >= 0, path, least)


def _dataset(row: Row) -> str:
    return str(row["dataset"])


RECORD = RowFile("error_budget.json", "budgets", 1, _dataset, _require_row)
