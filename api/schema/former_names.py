"""Names that changed in 0.2: JSON has both, queries take the old ones, till 0.3."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

#: Members of JSON objects: new name -> old name.
MEMBERS: Mapping[str, str] = {
    "own_error_deg": "own_deg",
    "rms_all_answers_deg": "charged_deg",
    "false_detection_rate": "false_sun",
    "ratio_to_smallest": "over_least",
    "represents": "stands_for",
    "partial_answer": "finer",
    "partial_dataset": "finer_dataset",
    "partial_extractor": "finer_extractor",
    "partial_model": "finer_model",
    "partial_own_error_deg": "finer_own_deg",
    "best_own_error_deg": "best_own_deg",
    "dataset_own_error_deg": "dataset_own_deg",
    "first_own_error_deg": "first_own_deg",
    "other_own_error_deg": "other_own_deg",
    "runner_up_own_error_deg": "runner_up_own_deg",
    "partial_over_bound": "finer_over_bound",
    "partial_availability": "finer_availability",
    "x_label": "across",
    "y_label": "up",
}
#: Parameters of queries: old name -> new name.
PARAMETERS: Mapping[str, str] = {"survive": "tolerate"}


def current_parameters(given: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return the parameters of a query by their new names, as columns in `sort` and `fields`."""
    return [
        (PARAMETERS.get(name, name), _current(value) if name in ("sort", "fields") else value)
        for name, value in given
    ]


def _current(column: str) -> str:
    """Return a column's new name: a member's, or one that begins or ends with it."""
    sign, bare = column[: column.startswith("-")], column.removeprefix("-")
    for new, old in MEMBERS.items():
        if bare == old:
            return sign + new
    for new, old in MEMBERS.items():
        if bare.startswith(f"{old}_") or bare.endswith(f"_{old}"):
            return sign + bare.replace(old, new)
    return column


def with_former_names(document: Any) -> Any:
    """Return a JSON document with the old names beside the new ones."""
    if isinstance(document, Mapping):
        found = {name: with_former_names(value) for name, value in document.items()}
        return found | {old: found[new] for new, old in MEMBERS.items() if new in found}
    if isinstance(document, list | tuple):
        return [with_former_names(item) for item in document]
    return document
