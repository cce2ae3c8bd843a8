"""Dataclasses as JSON data: `JsonData`, and `json_data` of any value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any


class JsonData:
    """The base of dataclasses whose JSON is their fields by name, in their order."""

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON data."""
        return _fields(self)


def json_data(value: Any) -> Any:
    """Return a value as JSON data: dataclasses and mappings as objects, tuples as arrays."""
    if isinstance(value, JsonData):
        return value.to_dict()
    if is_dataclass(value):
        return _fields(value)
    if isinstance(value, Mapping):
        return {key: json_data(one) for key, one in value.items()}
    return [json_data(one) for one in value] if isinstance(value, list | tuple) else value


def _fields(value: Any) -> dict[str, Any]:
    return {field.name: json_data(getattr(value, field.name)) for field in fields(value)}
