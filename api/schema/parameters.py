"""Types of parameters: what Pydantic takes too easily is refused, null is not offered.

A number is what JSON takes for one, so that a query and a body mean the same: no `+1`, `1_0`,
`nan` or `yes`. Words of a closed list are looked up when they are needed, and stand in the
OpenAPI document as an `enum`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, WrapValidator
from pydantic_core import CoreSchema, core_schema

LARGEST_PAGE = 500
DEFAULT_PAGE = 200
MOST_VALUES = 100  # of one parameter


class WordsUnreadableError(Exception):
    """The words of a closed list could not be read; the message says why."""


@dataclass(frozen=True)
class OneOf:
    """One of a closed list of words; `words` is called when they are needed."""

    words: Callable[[], Sequence[str]]

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Refuse other words."""
        return core_schema.no_info_after_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """List the words."""
        words = list(self.words())
        return {"type": "string", "enum": words} if words else {"type": "string", "maxLength": 0}

    def _check(self, word: str) -> str:
        try:
            words = self.words()
        except (ValueError, AssertionError) as error:  # Pydantic would take it for the word's fault
            raise WordsUnreadableError(str(error)) from error
        if word not in words:
            raise ValueError("not one of the words")
        return word


@dataclass(frozen=True)
class Spelt:
    """A value whose text has a form, and which is left out rather than null."""

    form: str

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Refuse other text before it is read; text in a body is refused by its strict model."""
        return core_schema.no_info_before_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Leave out null."""
        found = handler(schema)
        return next(iter(found.get("anyOf", [found])))

    def _check(self, value: Any) -> Any:
        if value is None or (
            isinstance(value, str) and not re.fullmatch(self.form, value, re.ASCII | re.DOTALL)
        ):
            raise ValueError(f"not of the form {self.form}")
        return value


class Whole(Spelt):
    """A whole number. JSON knows one kind of number: 3.0 is an integer."""

    def _check(self, value: Any) -> Any:
        given = super()._check(value)
        return int(given) if isinstance(given, float) and given.is_integer() else given


def _distinct(given: Any, read: Callable[[Any], list[str]]) -> list[str]:
    return sorted(set(read([given] if isinstance(given, str) else given)))


class OneOrSeveral:
    """Allows a word beside a list of words in the JSON Schema, as `_distinct` reads it."""

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the schema; `api.service.refusals.of_list` returns that of the list alone."""
        several = handler(schema)
        return {"anyOf": [several["items"], several]}


Word = TypeVar("Word")
Several = Annotated[
    list[Word], Field(max_length=MOST_VALUES), WrapValidator(_distinct), OneOrSeveral()
]


def several(description: str) -> Any:
    """Return the field of a parameter that may be given several times, or not at all."""
    return Field(default_factory=list, description=description)


GIVEN = Spelt(".*")
WHOLE = Whole(r"-?\d{1,18}")
NUMBER = Spelt(r"-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
Flag = Annotated[bool, Spelt("true|false")]

Limit = Annotated[
    int, Field(ge=1, le=LARGEST_PAGE, description="Maximum number of items per page."), WHOLE
]
SORT = Field(
    default=None,
    description="Column to sort by; - in front sorts in descending order. Rows without a value "
    "come last.",
)
FIELDS = several("Columns to return. JSON items are then flat table rows.")
Cursor = Annotated[
    str | None,
    Field(
        min_length=1,
        max_length=200,
        description="`next` of the previous page, with the same filters.",
    ),
    GIVEN,
]
