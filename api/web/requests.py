"""Reading a request more strictly than Starlette does, within bounds."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncGenerator, AsyncIterator
from contextlib import asynccontextmanager
from functools import cached_property
from typing import Any, NoReturn
from urllib.parse import parse_qsl

from python_multipart.multipart import parse_options_header
from starlette.datastructures import QueryParams
from starlette.exceptions import HTTPException
from starlette.requests import Request

from api.service.problems import Problem, Violation

FORM = "multipart/form-data"
MOST_FIELDS = 500  # of one query
LARGEST_BODY = 64 * 1024  # bytes; the longest sensible set of requirements is a twentieth of it
#: A body that brings fewer bytes a second, after so many seconds, is given up.
SLOWEST_PER_S, PATIENCE_S = 20_000, 10.0
_LONGEST_TYPE = 500  # characters of a Content-Type that are read: parsing it takes their square


class BodyProblem(Problem, HTTPException):
    """A body that is refused: what FastAPI, which reads it, passes on as it is."""


class StrictQuery(QueryParams):
    """The fields of a query, none of them lost: one that is given twice is both of its values."""

    def get(self, key: Any, default: Any = None) -> Any:
        """Return the value of a field, or the list of its values."""
        values = self.getlist(key)
        return values if len(values) > 1 else super().get(key, default)


class StrictRequest(Request):
    """A request whose query and JSON body are read whole and to the letter, or refused."""

    @cached_property  # FastAPI reads it once a dependency
    def query_params(self) -> StrictQuery:
        """The query; a `Problem` (400) where it cannot be read."""
        query: bytes = self.scope["query_string"]
        try:
            pairs = parse_qsl(
                query.decode("ascii"),
                keep_blank_values=True,
                strict_parsing=bool(query),
                errors="strict",
                max_num_fields=MOST_FIELDS,
            )
        except ValueError as error:
            expected = f"at most {MOST_FIELDS} fields name=value joined by &, percent-encoded UTF-8"
            violation = Violation("query", query.decode("latin-1"), expected)
            raise Problem(400, "malformed-query", errors=[violation]) from error
        return StrictQuery(pairs)

    async def body(self) -> bytes:
        """Return the body; a `Problem` (415, 413) where it is no JSON in UTF-8, or too long."""
        if not hasattr(self, "_body"):
            require_body(self, "application/json", "application/json in UTF-8", LARGEST_BODY)
            async with in_time() as clock:
                chunks = [chunk async for chunk in bounded(self, LARGEST_BODY, clock)]
            self._body = b"".join(chunks)
        return self._body or self._parse(b"")  # which FastAPI would take for no body

    async def json(self) -> Any:
        """Return the parsed body: RFC 8259, so no NaN, no Infinity, and no member twice.

        Raises
        ------
        Problem
            As `body`, and 400 where it is not JSON.
        """
        return self._parse(await self.body())

    def _parse(self, body: bytes) -> Any:
        try:
            return json.loads(
                body.decode("utf-8"), parse_constant=_refuse_constant, object_pairs_hook=_object
            )
        except (ValueError, RecursionError) as error:
            reason = "nested too deeply" if isinstance(error, RecursionError) else str(error)
            violation = Violation("body", None, f"JSON in UTF-8 ({reason})")
            raise BodyProblem(400, "malformed-json", errors=[violation]) from error


def require_body(request: Request, media: str, expected: str, largest: int) -> None:
    """Refuse a body by its headers, before it is read.

    Raises
    ------
    Problem
        415 for another media type or charset, a form without a boundary, a body that is
        compressed; 413 for one of more than `largest` bytes.
    """
    stated = request.headers.get("content-type")
    kind, options = parse_options_header((stated or "")[:_LONGEST_TYPE])
    plain = options.get(b"charset", b"utf-8").lower() == b"utf-8"
    bound = b"boundary" in options or media != FORM
    if not (kind == media.encode() and plain and bound):
        error = Violation("Content-Type", stated, expected)
        headers = {"Accept": media}
        raise BodyProblem(415, "unsupported-media-type", errors=[error], headers=headers)
    coding = request.headers.get("content-encoding", "identity")
    if coding.strip().lower() not in {"", "identity"}:
        error = Violation("Content-Encoding", coding, "identity: bodies are not compressed")
        headers = {"Accept-Encoding": "identity"}
        raise BodyProblem(415, "unsupported-media-type", errors=[error], headers=headers)
    length = request.headers.get("content-length", "")
    if length.isdecimal() and int(length) > largest:
        raise _too_long(length, largest)


@asynccontextmanager
async def in_time() -> AsyncIterator[asyncio.Timeout]:
    """Give the end of a body's time, which `bounded` puts off; a `Problem` (408) after it."""
    try:
        async with asyncio.timeout(PATIENCE_S) as clock:
            yield clock
    except TimeoutError as error:
        expected = f"at least {SLOWEST_PER_S} bytes/s after {PATIENCE_S:g} s"
        wrong = Violation("body", "fewer", expected)
        raise BodyProblem(408, "request-timeout", errors=[wrong]) from error


async def bounded(
    request: Request, largest: int, clock: asyncio.Timeout
) -> AsyncGenerator[bytes, None]:
    """Yield a body, each byte of which puts the end of the `clock` off.

    Raises
    ------
    Problem
        413 once it is longer than `largest` bytes.
    """
    begun, length = asyncio.get_running_loop().time(), 0
    async for chunk in request.stream():
        length += len(chunk)
        if length > largest:
            raise _too_long(f"{length} or more", largest)
        clock.reschedule(begun + PATIENCE_S + length / SLOWEST_PER_S)
        yield chunk


def _too_long(came: str, largest: int) -> BodyProblem:
    error = Violation("body", f"{came} bytes", f"at most {largest} bytes")
    return BodyProblem(413, "content-too-large", errors=[error])


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not JSON")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    members = dict(pairs)
    if len(members) < len(pairs):
        raise ValueError("an object has a member twice")
    return members
