"""Asking path functions in this process, for the examples of the documentation."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any

from api.service.asking import reading, refusing
from api.service.knowledge import Knowledge
from api.web.answers import Answer

PathFunction = Callable[..., Coroutine[Any, Any, Answer]]


def ask(endpoint: PathFunction, known: Knowledge, **given: Any) -> Answer:
    """Call a path function, its arguments as of `api.service.asking.ask`."""
    read: PathFunction = reading(endpoint)
    with refusing(endpoint):
        return asyncio.run(read(known=known, **given))
