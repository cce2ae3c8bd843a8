"""What path functions share."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Annotated, Any, TypeVar

from fastapi import Depends, Query, Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ValidationError

from api.http.knowledge import Knowledge
from api.http.negotiation import JSON, media_type
from api.schema.base import NoParameters, OnlyFormat

Asked = TypeVar("Asked", bound=BaseModel)


async def knowledge(request: Request) -> Knowledge:
    """Return what the application tells."""
    known: Knowledge = request.app.state.knowledge
    return known


async def json_accepted(request: Request) -> None:
    """Refuse a client that does not take JSON."""
    media_type(request.headers.get("accept"), (JSON,))


async def no_parameters(_query: Annotated[NoParameters, Query()]) -> None:
    """Refuse any query."""


def query_as(model: type[Asked]) -> Callable[[Request], Coroutine[Any, Any, Asked]]:
    """Return a dependency that reads a whole query into a model.

    FastAPI reads a query one parameter after another, which for forty of them takes as long as half
    an empty endpoint; the model reads all at once. `api.http.openapi` documents the parameters.

    Parameters
    ----------
    model : of the query; members that may be given several times have lists by default
    """
    model.model_rebuild()  # so that no question waits for it
    lists = {name for name, field in model.model_fields.items() if field.default_factory is list}

    async def read(request: Request) -> Asked:
        query = request.query_params
        given: dict[str, Any] = {}
        for name, value in query.multi_items():
            if name in lists:
                given.setdefault(name, []).append(value)
            else:
                given[name] = query.get(name)
        try:
            return model.model_validate(given)
        except ValidationError as error:
            errors = [{**one, "loc": ("query", *one["loc"])} for one in error.errors()]
            raise RequestValidationError(errors) from error

    return read


Known = Annotated[Knowledge, Depends(knowledge)]
JSON_ONLY = Depends(json_accepted)
NO_PARAMETERS = Depends(no_parameters)
TableOnly = Annotated[OnlyFormat, Query()]
AS_ACCEPTED = OnlyFormat.model_construct()
"""The query where none is given, as when a path function is called by another."""
