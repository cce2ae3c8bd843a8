"""Asking in this process what the service answers, without HTTP."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from functools import cache
from typing import Any

from pydantic import ConfigDict, ValidationError, validate_call

from api.service.knowledge import Knowledge
from api.service.refusals import refusal
from api.web.answers import Answer

PLACES = ("query", "body")  # what arguments that are models are called

PathFunction = Callable[..., Coroutine[Any, Any, Answer]]


def ask(endpoint: PathFunction, known: Knowledge, **given: Any) -> Answer:
    """Call a path function, its arguments read as those of a request are.

    Parameters
    ----------
    endpoint : the path function
    known : facts and measurements
    given : parts of the path by name; `query` and `body` as mappings

    Raises
    ------
    Problem
        For what does not fit, as over HTTP.
    """
    try:
        return asyncio.run(_reading(endpoint)(known=known, **given))
    except ValidationError as error:
        errors = [
            {**found, "loc": found["loc"] if found["loc"][0] in PLACES else ("path", *found["loc"])}
            for found in error.errors()
        ]
        raise refusal(errors, endpoint) from error


@cache
def _reading(endpoint: PathFunction) -> PathFunction:
    return validate_call(config=ConfigDict(arbitrary_types_allowed=True))(endpoint)
