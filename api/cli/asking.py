"""Asking in this process what the HTTP service answers, so that both always say the same."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from api.cli.working import working_directory
from api.cli.wrong_call import WrongCallError
from api.http.answers import Answer
from api.http.endpoint import Endpoint
from api.http.endpoints import all_endpoints
from api.http.knowledge import Knowledge
from api.http.measurements import Measurements
from api.http.problems import Problem, Violation


def ask(name: str, arguments: Mapping[str, Any], parts: Mapping[str, str] | None = None) -> Answer:
    """Return the service's answer.

    Parameters
    ----------
    name : of the endpoint
    arguments : by parameter name; None and empty lists ask nothing
    parts : variable parts of the path

    Raises
    ------
    WrongCallError
        For a value that is not valid, naming the option and the nearest valid value.
    """
    endpoint = _endpoints()[name]
    given = {name: value for name, value in arguments.items() if value not in (None, [], ())}
    where = dict(parts or {})
    try:
        for part in endpoint.parts:
            part.check(where[part.name])
        return endpoint.build(where, endpoint.parameters.from_body(given))
    except Problem as problem:
        options = set(given)
        raise WrongCallError("; ".join(_said(e, options) for e in problem.errors)) from problem


@cache
def knowledge() -> Knowledge:
    """Return what is known, with the times of this machine, loaded on first use."""
    return Knowledge(Measurements(times_directory=working_directory()))


@cache
def _endpoints() -> dict[str, Endpoint]:
    return {endpoint.name: endpoint for endpoint in all_endpoints(knowledge())}


def _said(error: Violation, options: set[str]) -> str:
    name = error.parameter
    what = f"--{name.replace('_', '-')}" if name in options else name
    hint = f"did you mean {error.nearest!r}?" if error.nearest else f"expected {error.expected}"
    return f"{what}: no {error.value!r}; {hint}"
