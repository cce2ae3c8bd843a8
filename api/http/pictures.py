"""A picture as an endpoint: drawn once, served as PNG with its ETag."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from fastapi import FastAPI, Request, Response
from fastapi.concurrency import run_in_threadpool

from api.http.answers import Answers
from api.http.endpoint import PathPart
from api.http.negotiation import PNG, media_type
from api.http.parameters import Parameters
from api.http.representations import Representation


@dataclass(frozen=True)
class Picture:
    """One operation of the service that answers with a picture.

    Attributes
    ----------
    path : template, as in OpenAPI
    name : operation identifier
    summary, description : for the documentation
    draw : makes the PNG from the parts of the path
    parts : variable parts of the path
    example : path parts of the example
    """

    path: str
    name: str
    summary: str
    description: str
    draw: Callable[[Mapping[str, str]], bytes]
    parts: tuple[PathPart, ...]
    example: Mapping[str, str]
    parameters: ClassVar[Parameters] = Parameters()  # takes none
    method: ClassVar[str] = "GET"

    def install(self, app: FastAPI, answers: Answers) -> None:
        """Serve the picture in `app`, from the cache of `answers` once it is drawn."""

        async def get(request: Request) -> Response:
            media_type(request.headers.get("accept"), (PNG,))
            self.parameters.from_query(request.scope["query_string"])
            given = request.path_params
            for part in self.parts:
                part.check(given[part.name])
            place = (request.scope["path"], "", PNG)
            found = answers.cache.get(place)
            if found is None:
                # Drawing takes a second, in which others shall be answered.
                body = await run_in_threadpool(self.draw, given)
                found = Representation(body, PNG, {"Vary": "Accept"}, compressible=False)
                answers.cache.put(place, found)
            return found.respond(request)

        app.add_api_route(
            self.path,
            get,
            methods=["GET"],
            name=self.name,
            operation_id=self.name,
            summary=self.summary,
            description=self.description,
            response_class=_PngResponse,
        )

    def content(self) -> dict[str, Any]:
        """Return the content of the answer as OpenAPI describes it."""
        return {PNG: {"schema": {"type": "string", "contentMediaType": PNG}}}


class _PngResponse(Response):
    """What FastAPI reads the media type of the documentation from."""

    media_type = PNG
