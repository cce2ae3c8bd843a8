"""An endpoint as data: what it takes, what it says, and how it is shown in the documentation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from fastapi import FastAPI, Request, Response
from pydantic import BaseModel

from api.http.answers import Answer, Answers
from api.http.bodies import read_json
from api.http.nearest import nearest
from api.http.parameters import Arguments, Parameters
from api.http.problems import Problem, Violation

Build = Callable[[Mapping[str, str], Arguments], Answer]


@dataclass(frozen=True)
class PathPart:
    """A variable part of a path: one of a closed list of words.

    Attributes
    ----------
    name : as in the path template
    description : for the documentation
    words : gives the valid words when they are needed
    """

    name: str
    description: str
    words: Callable[[], Sequence[str]]

    def check(self, text: str) -> None:
        """Raise the 404 that names the nearest word where `text` is not a word."""
        words = self.words()
        if text not in words:
            expected = "one of those listed" if len(words) > 20 else f"one of {', '.join(words)}"
            error = Violation(self.name, text, expected, nearest(text, words))
            raise Problem(404, f"unknown-{self.name}", errors=[error])


@dataclass(frozen=True)
class Endpoint:
    """One operation of the service.

    Attributes
    ----------
    path : template, as in OpenAPI
    name : operation identifier
    summary, description : for the documentation
    shape : model of the JSON answer
    build : answers, from path parts and arguments
    parameters : of the query, or of the body of a POST
    parts : variable parts of the path
    example : path parts of the example
    example_arguments : query of the example, or JSON body of a POST
    method : GET (which brings HEAD) or POST
    """

    path: str
    name: str
    summary: str
    description: str
    shape: type[BaseModel]
    build: Build
    parameters: Parameters = field(default_factory=Parameters)
    parts: tuple[PathPart, ...] = ()
    example: Mapping[str, str] = field(default_factory=dict)
    example_arguments: str | Mapping[str, Any] = ""
    method: Literal["GET", "POST"] = "GET"

    def example_answer(self) -> Answer:
        """Answer the example."""
        given = self.example_arguments
        arguments = (
            self.parameters.from_query(given.encode())
            if isinstance(given, str)
            else self.parameters.from_body(dict(given))
        )
        return self.build(self.example, arguments)

    def install(self, app: FastAPI, answers: Answers) -> None:
        """Serve the endpoint in `app`."""

        def bound(request: Request) -> Callable[[Arguments], Answer]:
            given = request.path_params
            for part in self.parts:
                part.check(given[part.name])
            return lambda arguments: self.build(given, arguments)

        async def get(request: Request) -> Response:
            return answers.get(request, self.parameters, bound(request))

        async def post(request: Request) -> Response:
            if request.scope["query_string"]:
                Parameters().from_query(request.scope["query_string"])
            body = await read_json(request)
            return answers.post(request, body, self.parameters, bound(request))

        app.add_api_route(
            self.path,
            get if self.method == "GET" else post,
            methods=[self.method],
            name=self.name,
            operation_id=self.name,
            summary=self.summary,
            description=self.description,
            response_model=self.shape,
        )
