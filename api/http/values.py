"""Kinds of values a parameter may take, each read from a query or a JSON body."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from api.http.nearest import nearest

_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?\Z", re.ASCII)
_INTEGER = re.compile(r"-?\d{1,18}\Z", re.ASCII)


class InvalidValueError(ValueError):
    """A value is not one the parameter takes; carries the nearest valid one."""

    def __init__(self, nearest_valid: str | None = None) -> None:
        super().__init__(nearest_valid)
        self.nearest = nearest_valid


class Kind(Protocol):
    """What one value of a parameter may be."""

    def from_text(self, text: str) -> Any:
        """Read a value from a query; InvalidValueError where it is not valid."""
        ...

    def from_json(self, value: object) -> Any:
        """Read a value from a JSON body; InvalidValueError where it is not valid."""
        ...

    def expected(self) -> str:
        """Say in words what is valid."""
        ...

    def schema(self) -> dict[str, Any]:
        """Return the JSON Schema of a value."""
        ...


@dataclass(frozen=True)
class Choice:
    """One of a closed list of words; `words` is called when they are needed."""

    words: Callable[[], Sequence[str]]

    def from_text(self, text: str) -> str:
        """Read a value from a query."""
        words = self.words()
        if text not in words:
            raise InvalidValueError(nearest(text, words))
        return text

    def from_json(self, value: object) -> str:
        """Read a value from a JSON body."""
        if not isinstance(value, str):
            raise InvalidValueError
        return self.from_text(value)

    def expected(self) -> str:
        """Say in words what is valid."""
        words = ", ".join(self.words())
        return f"one of {words}" if words else "nothing: there is no valid value"

    def schema(self) -> dict[str, Any]:
        """Return the JSON Schema of a value."""
        words = list(self.words())
        return {"type": "string", "enum": words} if words else {"type": "string", "maxLength": 0}


@dataclass(frozen=True)
class PositiveNumber:
    """A finite number above zero, up to a bound (included)."""

    maximum: float

    def from_text(self, text: str) -> float:
        """Read a value from a query."""
        if not _NUMBER.match(text):
            raise InvalidValueError
        return self._within(float(text))

    def from_json(self, value: object) -> float:
        """Read a value from a JSON body."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InvalidValueError
        # Compared before it is converted: an integer may be too long for a float.
        if isinstance(value, int) and not 0 < value <= self.maximum:
            raise InvalidValueError
        return self._within(float(value))

    def _within(self, value: float) -> float:
        if not (math.isfinite(value) and 0 < value <= self.maximum):
            raise InvalidValueError
        return value

    def expected(self) -> str:
        """Say in words what is valid."""
        return f"a number above 0, at most {self.maximum:g}"

    def schema(self) -> dict[str, Any]:
        """Return the JSON Schema of a value."""
        return {"type": "number", "exclusiveMinimum": 0, "maximum": self.maximum}


@dataclass(frozen=True)
class Integer:
    """A whole number between two bounds, both included."""

    minimum: int
    maximum: int

    def from_text(self, text: str) -> int:
        """Read a value from a query."""
        if not _INTEGER.match(text):
            raise InvalidValueError
        return self._within(int(text))

    def from_json(self, value: object) -> int:
        """Read a value from a JSON body."""
        if isinstance(value, float) and value.is_integer():
            value = int(value)  # JSON knows one kind of number: 3.0 is an integer
        if isinstance(value, bool) or not isinstance(value, int):
            raise InvalidValueError
        return self._within(value)

    def _within(self, value: int) -> int:
        if not self.minimum <= value <= self.maximum:
            raise InvalidValueError
        return value

    def expected(self) -> str:
        """Say in words what is valid."""
        return f"an integer from {self.minimum} to {self.maximum}"

    def schema(self) -> dict[str, Any]:
        """Return the JSON Schema of a value."""
        return {"type": "integer", "minimum": self.minimum, "maximum": self.maximum}


@dataclass(frozen=True)
class Text:
    """Free text of bounded length, of one character at least."""

    longest: int
    pattern: str | None = None

    def from_text(self, text: str) -> str:
        """Read a value from a query."""
        if not 1 <= len(text) <= self.longest:
            raise InvalidValueError
        if self.pattern is not None and not re.fullmatch(self.pattern, text):
            raise InvalidValueError
        return text

    def from_json(self, value: object) -> str:
        """Read a value from a JSON body."""
        if not isinstance(value, str):
            raise InvalidValueError
        return self.from_text(value)

    def expected(self) -> str:
        """Say in words what is valid."""
        form = f" of the form {self.pattern}" if self.pattern else ""
        return f"text of 1 to {self.longest} characters{form}"

    def schema(self) -> dict[str, Any]:
        """Return the JSON Schema of a value."""
        bounds = {"type": "string", "minLength": 1, "maxLength": self.longest}
        return {**bounds, "pattern": f"^{self.pattern}$"} if self.pattern else bounds


@dataclass(frozen=True)
class Flag:
    """True or false."""

    def from_text(self, text: str) -> bool:
        """Read a value from a query."""
        if text not in {"true", "false"}:
            raise InvalidValueError(nearest(text, ("true", "false")))
        return text == "true"

    def from_json(self, value: object) -> bool:
        """Read a value from a JSON body."""
        if not isinstance(value, bool):
            raise InvalidValueError
        return value

    def expected(self) -> str:
        """Say in words what is valid."""
        return "true or false"

    def schema(self) -> dict[str, Any]:
        """Return the JSON Schema of a value."""
        return {"type": "boolean"}
