"""Exception handlers: whatever goes wrong is answered with a problem document."""

from __future__ import annotations

import json
import logging
from collections.abc import Sequence
from http import HTTPStatus

from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from api.pages.serving import TWINS, refusal_page
from api.service.problems import MEDIA_TYPE, Problem, Violation
from api.service.refusals import refusal
from survey_data.nearest import nearest_name

#: Of a request whose client hung up, in counts and in the access log; as nginx has it.
CLIENT_LEFT = 499


def install(app: FastAPI, routes: Sequence[APIRoute]) -> None:
    """Make every refusal and failure of `app`, which serves `routes`, a problem document."""

    @app.exception_handler(HTTPException)
    @app.exception_handler(Problem)
    async def refused(request: Request, error: HTTPException | Problem) -> Response:
        if isinstance(error, Problem):
            return respond(request, error)
        error = _of_framework(error, request, routes)
        # Programs ask below /v1, and not for HTML.
        of_a_person = "text/html" in request.headers.get("accept", "")
        if of_a_person and not request.scope["path"].startswith("/v1/"):
            return refusal_page(request, error)
        return respond(request, error)

    @app.exception_handler(RequestValidationError)
    async def invalid(request: Request, error: RequestValidationError) -> Response:
        return respond(request, refusal(error.errors(), request.scope["endpoint"]))

    @app.exception_handler(ClientDisconnect)
    async def gone(request: Request, _error: ClientDisconnect) -> Response:
        # Nobody reads the answer, and Uvicorn logs only what is sent: the line is written here.
        of, path = "{}:{}".format(*(request.client or ("", 0))), request.scope["path"]
        said = (of, request.method, path, request.scope["http_version"], CLIENT_LEFT)
        logging.getLogger("uvicorn.access").info('%s - "%s %s HTTP/%s" %d', *said)
        return respond(request, Problem(CLIENT_LEFT, "client-closed-request"))

    @app.exception_handler(Exception)
    async def failed(request: Request, _error: Exception) -> Response:
        detail = "The service failed on this request; the cause is in its log."
        return respond(request, Problem(500, "internal-server-error", detail))


def respond(request: Request, problem: Problem) -> Response:
    """Return `problem` as the response to `request`."""
    # Not the answers' fast serialiser: input may hold lone surrogates, which only escaping carries.
    # The path is not taken from `request.url`, which fails where the query is not UTF-8.
    body = json.dumps(problem.document(request.scope["path"]))
    headers = {"Cache-Control": "no-store", **(problem.headers or {})}
    return Response(body, problem.status_code, headers, media_type=MEDIA_TYPE)


def _of_framework(error: HTTPException, request: Request, routes: Sequence[APIRoute]) -> Problem:
    """Return what Starlette refuses as a problem."""
    path: str = request.scope["path"]
    if error.status_code == HTTPStatus.NOT_FOUND:
        paths = {route.path for route in routes}
        # Twins are other spellings of a page's address: not what somebody meant who mistyped it.
        twins = {f"{page}{suffix}" for page in (*paths, "/answer") for suffix in TWINS}
        near = nearest_name(path, paths - twins, cutoff=0)
        violation = Violation("path", path, "a path of /openapi.json", near)
        return Problem(404, "unknown-path", errors=[violation])
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        there = [route.methods or set() for route in routes if route.path_regex.match(path)]
        offered = set().union(*there)
        allow = ", ".join(sorted(offered | {"HEAD"} if "GET" in offered else offered))
        violation = Violation("method", request.method, f"one of {allow}")
        return Problem(405, "method-not-allowed", errors=[violation], headers={"Allow": allow})
    kind = HTTPStatus(error.status_code).phrase.lower().replace(" ", "-")
    return Problem(error.status_code, kind, str(error.detail), headers=error.headers)
