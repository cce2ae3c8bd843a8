"""Reading the query of a request straight into its model, where that is all a request has.

FastAPI solves the dependencies of a path function anew for every request, one parameter after
another: with as many as a recommendation takes, that lasts as long as half a dozen empty answers.
What is read here means the same; whatever does not fit is left to FastAPI, which refuses it.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Coroutine, Mapping
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from fastapi import Request
from fastapi.params import Query
from pydantic import BaseModel, ValidationError

from api.http.problems import Problem
from api.http.requests import StrictQuery, StrictRequest

Direct = Callable[[Request], Coroutine[Any, Any, Any]]


def direct(endpoint: Callable[..., Any]) -> Direct | None:
    """Return what answers a request by a path function, or None where it does not fit.

    Parameters
    ----------
    endpoint : of a route without dependencies; has to take `known` and the model `query` alone

    Returns
    -------
    callable or None
        None where the path function takes anything else.
    """
    if list(inspect.signature(endpoint).parameters) != ["known", "query"]:
        return None
    hint = get_type_hints(endpoint, include_extras=True)["query"]
    model, *how = get_args(hint) if get_origin(hint) is Annotated else (hint,)
    if not (isinstance(model, type) and issubclass(model, BaseModel)):
        return None
    if not any(isinstance(one, Query) for one in how):
        return None
    lists = frozenset(
        name for name, field in model.model_fields.items() if field.default_factory is list
    )

    async def answer(request: Request) -> Any:
        asked = StrictRequest(request.scope, request.receive)
        try:
            query = model.model_validate(_fields(asked.query_params, lists))
        except (Problem, ValidationError):
            return None
        return await endpoint(known=request.app.state.knowledge, query=query)

    return answer


def _fields(query: StrictQuery, lists: frozenset[str]) -> Mapping[str, Any]:
    """Return the fields of a query by name; what is no list and given twice fits no model."""
    found: dict[str, Any] = {}
    for name, value in query.multi_items():
        if name in lists:
            found.setdefault(name, []).append(value)
        elif name in found:
            found[name] = query.getlist(name)
        else:
            found[name] = value
    return found
