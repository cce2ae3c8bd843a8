"""Routes whose whole query is read at once."""

from __future__ import annotations

from typing import Any

from fastapi import Request, Response
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ValidationError

from api.service.refusals import asked_models
from api.web.answers import AnswerRoute, Handler
from api.web.requests import StrictRequest


class QueryRoute(AnswerRoute):
    """A route whose path function takes, where it is asked by GET, `known` and `query` alone.

    FastAPI reads a query parameter by parameter, which for forty of them takes half the time of an
    empty endpoint, and resolves dependencies one after another, which takes an eighth. Here the
    model reads the whole query.
    """

    def computing(self) -> Handler:
        """Return what computes an answer that is not kept."""
        if self.methods != {"GET"}:
            return super().computing()
        endpoint, model = self.endpoint, asked_models(self.endpoint)["query"]
        model.model_rebuild()  # so that no question waits for it
        fields = model.model_fields.items()
        lists = {name for name, field in fields if field.default_factory is list}

        async def compute(request: Request) -> Response:
            known = request.app.state.knowledge
            strict = StrictRequest(request.scope, request.receive)
            answer: Response = await endpoint(known=known, query=read(strict, model, lists))
            return answer

        return compute


def read(request: StrictRequest, model: type[BaseModel], lists: set[str]) -> BaseModel:
    """Read a query into a model.

    Parameters
    ----------
    request : whose query it is
    model : of the query
    lists : members that may be given several times

    Raises
    ------
    RequestValidationError
        Where it does not fit.
    """
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
