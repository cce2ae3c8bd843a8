"""What the service knows, loaded once for all pages."""

from __future__ import annotations

from functools import cache

from api.service.knowledge import Knowledge


@cache
def knowledge() -> Knowledge:
    """Return facts, implementations and published measurements."""
    return Knowledge()
