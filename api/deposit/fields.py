"""Table schemas of the bundle's measured tables, from the data dictionary (`api.dictionary`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from api.dictionary import COLUMNS

TABLE_SCHEMA = "https://datapackage.org/profiles/2.0/tableschema.json"


def schema(
    columns: Sequence[str],
    where: str,
    *,
    primary: Sequence[str],
    foreign: Mapping[str, tuple[str, str]] | None = None,
) -> dict[str, Any]:
    """Describe a table as Table Schema v2.

    Parameters
    ----------
    columns : of the table, in order
    where : the table's name, for messages
    primary : columns that identify a row
    foreign : column -> (resource, column) that its values stand in

    Raises
    ------
    ValueError
        For a column nothing is known of: a table does not go out half described.
    """
    unknown = [name for name in columns if name not in COLUMNS]
    if unknown:
        raise ValueError(
            f"{where}: no description of column {', '.join(unknown)} in api.dictionary"
        )
    required = {*primary, *(foreign or {})}
    fields = []
    for name in columns:
        kind, description = COLUMNS[name]
        field: dict[str, Any] = {"name": name, "type": kind, "description": description}
        if name in required:
            field["constraints"] = {"required": True}
        fields.append(field)
    described: dict[str, Any] = {
        "$schema": TABLE_SCHEMA,
        "fields": fields,
        "missingValues": [""],
        "primaryKey": list(primary),
    }
    if foreign:
        described["foreignKeys"] = [
            {"fields": [column], "reference": {"resource": resource, "fields": [target]}}
            for column, (resource, target) in foreign.items()
        ]
    return described
