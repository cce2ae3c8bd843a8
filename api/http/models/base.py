"""What the models of answers and of questions have in common."""

from __future__ import annotations

from typing import Any, Protocol

from pydantic import BaseModel, ConfigDict, Field


class Shape(BaseModel):
    """An answer or a part of one: exactly these members."""

    model_config = ConfigDict(extra="forbid")


class OpenShape(BaseModel):
    """An answer or a part of one whose producer may say more than these members."""

    model_config = ConfigDict(extra="allow")


class Listing(Shape):
    """A page of a list."""

    total: int = Field(description="Items of the whole list.")
    next: str | None = Field(description="Cursor of the next page; null on the last.")


class Question(BaseModel):
    """The parameters of a query or a body: these and no others."""

    model_config = ConfigDict(extra="forbid")


class NoParameters(Question):
    """The query of an endpoint that takes none."""


class Paged(Protocol):
    """A question for a page of a list."""

    limit: int
    cursor: str | None

    def model_dump(self, *, exclude_defaults: bool) -> dict[str, Any]:
        """Return what is asked, as any model does."""
        ...
