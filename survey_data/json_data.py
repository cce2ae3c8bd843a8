"""The base of dataclasses whose JSON is their fields by name, in their order."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from pydantic_core import to_jsonable_python


class JsonData:
    """A dataclass with its JSON."""

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON data: dataclasses and mappings as objects, tuples as arrays."""
        members = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        found: dict[str, Any] = to_jsonable_python(members, fallback=dict)
        return found
