"""The base of dataclasses whose JSON is their fields by name, in their order."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any


class JsonData:
    """A dataclass with its JSON."""

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON data."""
        return asdict(self)  # type: ignore[call-overload, no-any-return]
