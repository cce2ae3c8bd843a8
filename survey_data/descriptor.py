"""The Data Package descriptor: which tables there are, their columns and types."""

from __future__ import annotations

import copy
import json
from functools import cache
from pathlib import Path
from typing import Any

DATA_DIRECTORY = Path(__file__).parent
DESCRIPTOR_FILE = "datapackage.json"


@cache
def _ship() -> dict[str, Any]:
    text = (DATA_DIRECTORY / DESCRIPTOR_FILE).read_text(encoding="utf-8")
    descriptor: dict[str, Any] = json.loads(text)
    return descriptor


def descriptor() -> dict[str, Any]:
    """Return a fresh copy of the Data Package (v2) descriptor the code is written for."""
    return copy.deepcopy(_ship())


def table_names() -> tuple[str, ...]:
    """Return the names of the tables, in the order of the descriptor."""
    return tuple(resource["name"] for resource in _ship()["resources"])


def file_name(table: str) -> str:
    """Return the file a table stands in, e.g. ``studies.csv``."""
    return str(_resource(table)["path"])


def column_types(table: str) -> dict[str, str]:
    """Return column -> Table Schema type of a table, in the order of its columns."""
    return {field["name"]: field["type"] for field in _resource(table)["schema"]["fields"]}


def primary_key(table: str) -> tuple[str, ...]:
    """Return the columns that together name a row (primary key, or else the unique key)."""
    schema = _resource(table)["schema"]
    return tuple(schema.get("primaryKey") or schema["uniqueKeys"][0])


def _resource(table: str) -> dict[str, Any]:
    for resource in _ship()["resources"]:
        if resource["name"] == table:
            return dict(resource)
    raise KeyError(f"no table {table!r}; there are {', '.join(table_names())}")
