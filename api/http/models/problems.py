"""Refusals (RFC 9457)."""

from __future__ import annotations

from pydantic import Field

from api.http.models.base import Shape


class Violation(Shape):
    """An error in a request."""

    parameter: str
    value: str | None
    expected: str
    nearest: str | None = Field(description="The nearest valid name or value.")


class ProblemDocument(Shape):
    """A refusal (RFC 9457)."""

    type: str
    title: str
    status: int
    detail: str
    instance: str
    errors: list[Violation]
