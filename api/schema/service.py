"""State of the service, and its refusals (RFC 9457)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from api.schema.base import Shape


class Health(Shape):
    """State of the service."""

    status: Literal["ok"]
    version: str
    studies: int
    datasets: int
    scores: int
    facts_sha256: str | None = Field(description="Digest of the survey's tables; null if unknown.")
    record_sha256: str | None = Field(description="Digest of the published results.")


class Violation(Shape):
    """An error in a request."""

    parameter: str = Field(description="Name of the parameter.")
    value: str | None
    expected: str = Field(description="Expected value.")
    nearest: str | None = Field(description="The nearest valid name or value.")


class ProblemDocument(Shape):
    """A refusal (RFC 9457)."""

    type: str
    title: str
    status: int
    detail: str
    instance: str = Field(description="Path of the request.")
    errors: list[Violation] = Field(description="Errors in the request.")
