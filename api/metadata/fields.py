"""Table schemas of the bundle's tables, from the models of their rows (`api.schema`)."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from api.schema.table import Model, described_columns

TABLE_SCHEMA = "https://datapackage.org/profiles/2.0/tableschema.json"


def fields(
    model: Model, columns: Sequence[str], required: Collection[str] = ()
) -> list[dict[str, Any]]:
    """Describe columns as fields of a Table Schema.

    Raises
    ------
    ValueError
        For a column that the model does not have or describe.
    """
    known = described_columns(model)
    unknown = [name for name in columns if name not in known or not known[name].description]
    if unknown:
        raise ValueError(f"{model.__name__} does not describe column {', '.join(unknown)}")
    made = []
    for name in columns:
        column = known[name]
        field: dict[str, Any] = {
            "name": name,
            "type": column.type,
            "description": column.description,
        }
        if name in required:
            field["constraints"] = {"required": True}
        made.append(field)
    return made


def schema(
    model: Model,
    columns: Sequence[str],
    *,
    primary: Sequence[str],
    foreign: Mapping[str, Sequence[str]] | None = None,
) -> dict[str, Any]:
    """Describe a table as Table Schema v2.

    Parameters
    ----------
    model, columns : as `fields`
    primary : columns that identify a row
    foreign : column -> (resource, column) that its values stand in

    Raises
    ------
    ValueError
        As `fields`: a table does not go out half described.
    """
    described: dict[str, Any] = {
        "$schema": TABLE_SCHEMA,
        "fields": fields(model, columns, {*primary, *(foreign or {})}),
        "missingValues": [""],
        "primaryKey": list(primary),
    }
    if foreign:
        described["foreignKeys"] = [
            {"fields": [column], "reference": {"resource": resource, "fields": [target]}}
            for column, (resource, target) in foreign.items()
        ]
    return described
