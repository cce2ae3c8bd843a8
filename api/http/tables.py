"""Rows as CSV (RFC 4180): nested objects become columns, lists are joined."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from typing import Any

LIST_SEPARATOR = "; "


def flattened(row: Mapping[str, Any], prefix: str = "") -> dict[str, str]:
    """Return one text a column; a member of a nested object is a column `outer_inner`.

    Lists of words are joined by "; ". Nothing (null) is an empty cell.
    """
    cells: dict[str, str] = {}
    for name, value in row.items():
        if isinstance(value, Mapping):
            cells.update(flattened(value, f"{prefix}{name}_"))
        else:
            cells[prefix + name] = cell(value)
    return cells


def cell(value: Any) -> str:
    """Return a value as the text of a CSV cell."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return "" if value != value else repr(value)  # noqa: PLR0124 - NaN
    if isinstance(value, Mapping):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Sequence) and not isinstance(value, str):
        return LIST_SEPARATOR.join(cell(item) for item in value)
    return str(value)


def to_csv(columns: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> bytes:
    """Return a table in UTF-8 with a header line.

    Parameters
    ----------
    columns : the leading columns, which stand even where no row has them; columns that rows
        have besides follow in the order they are met
    rows : one mapping a row
    """
    flat = [flattened(row) for row in rows]
    header = list(columns)
    known = set(header)
    for cells in flat:
        for name in cells:
            if name not in known:
                known.add(name)
                header.append(name)
    stream = io.StringIO(newline="")
    writer = csv.DictWriter(stream, header, restval="")
    writer.writeheader()
    writer.writerows(flat)
    return stream.getvalue().encode()
