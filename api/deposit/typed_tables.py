"""The tables of a bundle with types: what Parquet and SQLite are made of.

Read back from the CSV and the descriptor that the bundle holds, so that the three cannot differ.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Value = str | int | float | bool | None

_BOOLEANS = {"true": True, "false": False}
_READ: Mapping[str, Callable[[str], Value]] = {
    "string": str,
    "integer": int,
    "year": int,
    "number": float,
    "boolean": _BOOLEANS.__getitem__,
}


class CellError(ValueError):
    """A cell is not of its column's type; the message names file, row and column."""


@dataclass(frozen=True)
class TypedTable:
    """A table with typed columns.

    Attributes
    ----------
    resource : its entry in datapackage.json
    columns : values by column, None where nothing is known
    """

    resource: Mapping[str, Any]
    columns: Mapping[str, list[Value]]

    @property
    def name(self) -> str:
        """Of the resource."""
        return str(self.resource["name"])

    @property
    def fields(self) -> list[Mapping[str, Any]]:
        """Name, type and description of each column."""
        return list(self.resource["schema"]["fields"])

    @property
    def rows(self) -> list[tuple[Value, ...]]:
        """The values by row."""
        return list(zip(*self.columns.values(), strict=True))


def typed_tables(bundle: Path, descriptor: Mapping[str, Any]) -> list[TypedTable]:
    """Read the tables of a bundle, in the order of its descriptor.

    Raises
    ------
    CellError
        Where a cell is not of its column's type.
    """
    return [
        _typed(bundle / resource["path"], resource)
        for resource in descriptor["resources"]
        if resource.get("type") == "table"
    ]


def _typed(path: Path, resource: Mapping[str, Any]) -> TypedTable:
    header, *rows = csv.reader(io.StringIO(path.read_text("utf-8"), newline=""))
    fields = resource["schema"]["fields"]
    names = [field["name"] for field in fields]
    if header != names:
        raise CellError(f"{path}: columns are {header}, described are {names}")
    columns: dict[str, list[Value]] = {}
    for place, field in enumerate(fields):
        read = _READ[field["type"]]
        column: list[Value] = []
        for number, row in enumerate(rows, start=2):
            try:
                column.append(read(row[place]) if row[place] else None)
            except (ValueError, KeyError, IndexError) as error:
                raise CellError(
                    f"{path}, row {number}, column {field['name']}: expected {field['type']}, "
                    f"got {row[place : place + 1]}"
                ) from error
        columns[field["name"]] = column
    return TypedTable(resource, columns)
