"""State of the service."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from api.http.models.base import Shape


class Health(Shape):
    """State of the service."""

    status: Literal["ok"]
    version: str
    studies: int
    datasets: int
    scores: int
    facts_sha256: str | None = Field(description="Digest of the survey's tables; null if unknown.")
    record_sha256: str | None = Field(
        description="Digest of the published results; null if unknown."
    )
