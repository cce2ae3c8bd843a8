"""What stands in a cell of a table, or in a document: plain values, and their one spelling."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from registry.taxonomy import NO_IMPLEMENTATION_STATED, NONE_STATED

LIST_SEPARATOR = "; "
_PLAIN = frozenset((str, int, bool, type(None)))


def plain_value(value: Any) -> Any:
    """Return a value made of what JSON knows: sets sorted, numbers that are not finite None."""
    if type(value) in _PLAIN:
        return value
    if isinstance(value, Mapping):
        return {str(name): plain_value(member) for name, member in value.items()}
    if isinstance(value, set | frozenset):
        return sorted(plain_value(member) for member in value)
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [plain_value(member) for member in value]
    if isinstance(value, bool | int | str) or value is None:
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    raise TypeError(f"expected text, numbers, lists and mappings; got {type(value).__name__}")


def cell(value: Any) -> str:  # noqa: PLR0911 - a kind of value each
    """Return a value as the text of a CSV cell: lists joined by "; ", nothing found empty.

    The taxonomy's value "None" is spelled out (`registry.taxonomy.NONE_STATED`), also in lists.
    Numbers have all their digits; the record spells its own shorter, to be compared by line
    (`benchmark.results.csv_tables.format_cell`).
    """
    # What most cells hold is known by its exact type: tables have hundreds of thousands of them,
    # and asking whether text is a mapping takes longer than to write it.
    kind = type(value)
    if kind is str:
        return NONE_STATED if value == NO_IMPLEMENTATION_STATED else str(value)
    if kind is int or (kind is float and math.isfinite(value)):
        return str(value)
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return json.dumps(plain_value(value), ensure_ascii=False)
    if isinstance(value, Sequence | frozenset | set) and not isinstance(value, str):
        return LIST_SEPARATOR.join(cell(member) for member in plain_value(value))
    return str(value)
