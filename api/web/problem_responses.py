"""Refusals as responses."""

from __future__ import annotations

import json

from fastapi import Request, Response

from api.service.problems import MEDIA_TYPE, Problem


def respond(request: Request, problem: Problem) -> Response:
    """Return `problem` as the response to `request`."""
    # Not the answers' fast serialiser: input may hold lone surrogates, which only escaping carries.
    # The path is not taken from `request.url`, which fails where the query is not UTF-8.
    body = json.dumps(problem.document(request.scope["path"])).encode()
    headers = {"Cache-Control": "no-store", **(problem.headers or {})}
    return Response(body, problem.status_code, headers, media_type=MEDIA_TYPE)
