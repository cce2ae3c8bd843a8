"""State of the service."""

from __future__ import annotations

from typing import Literal

from api.http.models.base import Shape


class Health(Shape):
    """State of the service."""

    status: Literal["ok"]
    version: str
    studies: int
    datasets: int
    scores: int
