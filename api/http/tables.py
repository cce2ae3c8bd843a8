"""Rows as CSV (RFC 4180): nested objects become columns, lists are joined."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any

from api.cells import cell


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
