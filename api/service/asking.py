"""Asking the service in this process, as a request asks it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, TypeVar

from pydantic import ConfigDict, ValidationError, validate_call

from api.service.knowledge import Knowledge
from api.service.refusals import refusal

PLACES = ("query", "body")  # what arguments that are models are called

Answered = TypeVar("Answered")


def ask(function: Callable[..., Answered], known: Knowledge, **given: Any) -> Answered:
    """Call a function of the service, its arguments read as those of a request are.

    Parameters
    ----------
    function : that answers
    known : facts and measurements
    given : parts of the path by name; `query` and `body` as mappings

    Raises
    ------
    Problem
        For what does not fit, as over HTTP.
    """
    read: Callable[..., Answered] = reading(function)
    with refusing(function):
        return read(known=known, **given)


@contextmanager
def refusing(function: Callable[..., Any]) -> Iterator[None]:
    """Refuse what does not fit a function's arguments as a request that does not fit is."""
    try:
        yield
    except ValidationError as error:
        errors = [
            {**found, "loc": found["loc"] if found["loc"][0] in PLACES else ("path", *found["loc"])}
            for found in error.errors()
        ]
        raise refusal(errors, function) from error


@cache
def reading(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that reads its arguments by their types."""
    return validate_call(config=ConfigDict(arbitrary_types_allowed=True))(function)
