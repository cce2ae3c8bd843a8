"""Asking the service in this process, as HTTP does, so that both always say the same."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

from api.cli.wrong_call import WrongCallError, unfit
from api.service import asking
from api.service.documents import Document
from api.service.knowledge import Knowledge
from api.service.problems import Problem, Violation


def ask(
    function: Callable[..., Document], query: Mapping[str, Any] | None = None, **parts: str
) -> Document:
    """Return the service's document; None and empty lists ask nothing.

    A value that is not valid is a `WrongCallError`, with the option and the nearest valid value.
    """
    given = {name: value for name, value in (query or {}).items() if value not in (None, [], ())}
    arguments = parts if query is None else {**parts, "query": given}
    try:
        return asking.ask(function, knowledge(), **arguments)
    except Problem as problem:
        raise WrongCallError("; ".join(_said(e, set(given)) for e in problem.errors)) from problem


@cache
def knowledge() -> Knowledge:
    """Return what is known, loaded on first use."""
    return Knowledge()


#: What a person calls a part of a path, and the command that lists what it can be.
_PARTS = {
    "key": ("study", "sunatlas studies"),
    "id": ("claim", "sunatlas claims"),
    "name": ("data set", "sunatlas dataset list"),
}
_MOST = 12  # words that a refusal lists


def _said(error: Violation, options: set[str]) -> str:
    name = error.parameter
    if name in _PARTS and name not in options:
        what, listed = _PARTS[name]
        hint = f"did you mean {error.nearest!r}? " if error.nearest else ""
        return f"no {what} {error.value!r}; {hint}`{listed}` lists them"
    option = f"--{name.replace('_', '-')}" if name in options else name
    expected = error.expected
    words = expected.removeprefix("one of ").split(", ")
    if expected.startswith("one of ") and len(words) > _MOST:
        expected = f"one of {len(words)}, such as {words[0]} and {words[-1]}"
    return f"{option}: {unfit(error.value, expected, error.nearest)}"
