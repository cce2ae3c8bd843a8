"""Asking in this process what the HTTP service answers, so that both always say the same."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from api.cli.working import working_directory
from api.cli.wrong_call import WrongCallError
from api.http import asking
from api.http.answers import Answer
from api.http.knowledge import Knowledge
from api.http.measurements import Measurements
from api.http.problems import Problem, Violation


def ask(
    endpoint: asking.PathFunction, query: Mapping[str, Any] | None = None, **parts: str
) -> Answer:
    """Return the service's answer.

    Parameters
    ----------
    endpoint : the path function that answers
    query : by parameter name; None and empty lists ask nothing
    parts : variable parts of the path

    Raises
    ------
    WrongCallError
        For a value that is not valid, naming the option and the nearest valid value.
    """
    given = {name: value for name, value in (query or {}).items() if value not in (None, [], ())}
    arguments = parts if query is None else {**parts, "query": given}
    try:
        return asking.ask(endpoint, knowledge(), **arguments)
    except Problem as problem:
        raise WrongCallError("; ".join(_said(e, set(given)) for e in problem.errors)) from problem


@cache
def knowledge() -> Knowledge:
    """Return what is known, with the times of this machine, loaded on first use."""
    return Knowledge(Measurements(times_directory=working_directory()))


def _said(error: Violation, options: set[str]) -> str:
    name = error.parameter
    what = f"--{name.replace('_', '-')}" if name in options else name
    hint = f"did you mean {error.nearest!r}?" if error.nearest else f"expected {error.expected}"
    return f"{what}: no {error.value!r}; {hint}"
