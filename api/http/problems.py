"""Refusals as RFC 9457 problem documents."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request, Response
from starlette.exceptions import HTTPException

from api.http.nearest import nearest

MEDIA_TYPE = "application/problem+json"
TYPE_PREFIX = "urn:problem-type:sun-sensor-atlas:"
LONGEST_ECHO = 200  # characters of the caller's own input that a problem repeats


@dataclass(frozen=True)
class Violation:
    """One thing wrong with a request.

    Attributes
    ----------
    parameter : the name of the parameter, body field, header or path part
    value : what came, shortened; None where nothing came
    expected : what would have been accepted, in words
    nearest : the nearest valid name or value, if any is alike
    """

    parameter: str
    value: str | None
    expected: str
    nearest: str | None = None

    def document(self) -> dict[str, str | None]:
        """As a member of the problem's `errors`."""
        value = self.value
        if value is not None and len(value) > LONGEST_ECHO:
            value = value[:LONGEST_ECHO] + "…"
        return {
            "parameter": self.parameter[:LONGEST_ECHO],
            "value": value,
            "expected": self.expected,
            "nearest": self.nearest,
        }

    def sentence(self) -> str:
        """As a part of the problem's `detail`."""
        shown = self.document()
        hint = f"; the nearest is {self.nearest!r}" if self.nearest is not None else ""
        got = "nothing" if self.value is None else repr(shown["value"])
        return f"{shown['parameter']}: expected {self.expected}, got {got}{hint}"


class Problem(Exception):  # noqa: N818 - the RFC's own word
    """A request that is refused.

    Parameters
    ----------
    status : HTTP status code, 4xx
    kind : slug of the problem type; the type is `urn:problem-type:sun-sensor-atlas:<kind>`
    detail : what is wrong with this request; made from `errors` where left out
    errors : the violations found, every one of them
    headers : response headers, such as `Allow`
    """

    def __init__(
        self,
        status: int,
        kind: str,
        detail: str | None = None,
        errors: Sequence[Violation] = (),
        headers: Mapping[str, str] | None = None,
    ) -> None:
        self.status = status
        self.kind = kind
        self.errors = tuple(errors)
        self.detail = detail or "; ".join(error.sentence() for error in self.errors)
        self.headers = dict(headers or {})
        super().__init__(self.detail)

    def document(self, instance: str) -> dict[str, Any]:
        """Return the members of the problem document; `instance` is the path asked for."""
        return {
            "type": TYPE_PREFIX + self.kind,
            "title": self.kind.replace("-", " ").capitalize(),
            "status": self.status,
            "detail": self.detail,
            "instance": instance,
            "errors": [error.document() for error in self.errors],
        }


def respond(request: Request, problem: Problem) -> Response:
    """Return `problem` as the response to `request`."""
    # Not the answers' fast serialiser: input may hold lone surrogates, which only escaping carries.
    body = json.dumps(problem.document(request.url.path)).encode()
    headers = {"Cache-Control": "no-store", **problem.headers}
    return Response(body, problem.status, headers, media_type=MEDIA_TYPE)


def install(app: FastAPI) -> None:
    """Make every refusal and failure of `app` a problem document."""

    async def refused(request: Request, error: Exception) -> Response:
        if not isinstance(error, Problem):
            raise error
        return respond(request, error)

    async def by_framework(request: Request, error: Exception) -> Response:
        if not isinstance(error, HTTPException):
            raise error
        if error.status_code == HTTPStatus.NOT_FOUND:
            problem = unknown_path(app, request)
        elif error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            problem = method_not_allowed(app, request)
        else:
            phrase = HTTPStatus(error.status_code).phrase
            problem = Problem(
                error.status_code,
                phrase.lower().replace(" ", "-"),
                str(error.detail),
                headers=error.headers,
            )
        return respond(request, problem)

    async def failed(request: Request, _error: Exception) -> Response:
        detail = "The service failed on this request; the cause is in its log."
        return respond(request, Problem(500, "internal-server-error", detail))

    app.add_exception_handler(Problem, refused)
    app.add_exception_handler(HTTPException, by_framework)
    app.add_exception_handler(Exception, failed)


def paths(app: FastAPI) -> dict[str, set[str]]:
    """Return the methods of every path template that `app` serves."""
    served: dict[str, set[str]] = {}
    for route in app.routes:
        methods = getattr(route, "methods", None)
        path = getattr(route, "path", None)
        if methods and isinstance(path, str):
            served.setdefault(path, set()).update(methods)
    return served


def unknown_path(app: FastAPI, request: Request) -> Problem:
    """Return the problem of a path that is not served, naming the nearest one."""
    path = request.url.path
    served = paths(app)
    error = Violation("path", path, "a path of /openapi.json", nearest(path, served))
    return Problem(404, "unknown-path", errors=[error])


def method_not_allowed(app: FastAPI, request: Request) -> Problem:
    """Return the problem of a method that a path does not offer; `Allow` lists what it does."""
    offered: set[str] = set()
    for route in app.routes:
        regex = getattr(route, "path_regex", None)
        if regex is not None and regex.match(request.scope["path"]):
            offered |= set(getattr(route, "methods", None) or ())
    if "GET" in offered:
        offered.add("HEAD")
    allow = ", ".join(sorted(offered))
    error = Violation("method", request.method, f"one of {allow}")
    return Problem(405, "method-not-allowed", errors=[error], headers={"Allow": allow})
