"""Reading a JSON request body, with bounds."""

from __future__ import annotations

import json
from typing import Any, NoReturn

from fastapi import Request

from api.http.problems import Problem, Violation

LARGEST_BODY = 64 * 1024  # bytes; the longest sensible set of requirements is a twentieth of it


async def read_json(request: Request) -> object:
    """Return the parsed JSON body of `request`.

    Raises
    ------
    Problem
        415 where the body is said to be something else than JSON in UTF-8, 413 where it is too
        long, 400 where it is not JSON (RFC 8259: no NaN, no Infinity, no member twice).
    """
    _require_json(request)
    chunks: list[bytes] = []
    length = 0
    async for chunk in request.stream():
        length += len(chunk)
        if length > LARGEST_BODY:
            error = Violation("body", f"{length} bytes or more", f"at most {LARGEST_BODY} bytes")
            raise Problem(413, "content-too-large", errors=[error])
        chunks.append(chunk)
    try:
        return json.loads(
            b"".join(chunks).decode("utf-8"),
            parse_constant=_refuse_constant,
            object_pairs_hook=_object,
        )
    except (ValueError, RecursionError) as error:
        reason = "nested too deeply" if isinstance(error, RecursionError) else str(error)
        violation = Violation("body", None, f"JSON in UTF-8 ({reason})")
        raise Problem(400, "malformed-json", errors=[violation]) from error


def _require_json(request: Request) -> None:
    content_type = request.headers.get("content-type")
    media, *arguments = (part.strip().lower() for part in (content_type or "").split(";"))
    charsets = [part.partition("=")[2].strip('"') for part in arguments if part[:8] == "charset="]
    if media != "application/json" or any(charset != "utf-8" for charset in charsets):
        error = Violation("Content-Type", content_type, "application/json in UTF-8")
        raise Problem(
            415, "unsupported-media-type", errors=[error], headers={"Accept": "application/json"}
        )
    coding = request.headers.get("content-encoding", "identity")
    if coding.strip().lower() not in {"", "identity"}:
        error = Violation("Content-Encoding", coding, "identity: bodies are not compressed")
        raise Problem(
            415, "unsupported-media-type", errors=[error], headers={"Accept-Encoding": "identity"}
        )


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not JSON")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    members = dict(pairs)
    if len(members) < len(pairs):
        raise ValueError("an object has a member twice")
    return members
