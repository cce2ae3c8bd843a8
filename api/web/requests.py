"""Reading a request more strictly than Starlette does, within bounds."""

from __future__ import annotations

import asyncio
import json
import logging
from collections.abc import AsyncGenerator
from functools import cached_property
from typing import Any, NoReturn
from urllib.parse import parse_qsl

from python_multipart.multipart import parse_options_header
from starlette.datastructures import FormData, QueryParams
from starlette.exceptions import HTTPException
from starlette.formparsers import MultiPartException, MultiPartParser
from starlette.requests import Request

from api.schema.former_names import PARAMETERS, current_parameters
from api.service.problems import Problem, Violation
from calibrate.uploaded import LARGEST

JSON, FORM = "application/json", "multipart/form-data"
MOST_FIELDS = 500  # of one query
LARGEST_JSON = 64 * 1024  # bytes; the longest sensible set of requirements is a twentieth of it
#: Bytes of the fields of a form, each and all: a config, and what separates parts; with files.
LARGEST_FIELD = 100_000
LARGEST_FORM = LARGEST + LARGEST_FIELD
#: Files of a form, and fields; python-multipart bounds the heads of each (8 lines of 4 kB), which
#: take the square of their semicolons to parse.
MOST_PARTS, MOST_SEMICOLONS = 40, 50
#: A body that brings fewer bytes a second, after so many seconds, is given up.
SLOWEST_PER_S, PATIENCE_S = 20_000, 10.0
#: Bytes of all bodies that a process reads in a second, which is a third of its time.
MOST_PER_S = 40_000_000
_LONGEST_TYPE = 500  # characters of a Content-Type: parsing it takes their square
logging.getLogger("python_multipart").setLevel(logging.ERROR)  # what it refuses, we answer


class BodyProblem(Problem, HTTPException):
    """A body that is refused: what FastAPI, which reads it, passes on as it is."""


class StrictQuery(QueryParams):
    """The fields of a query, none of them lost: one that is given twice is both of its values."""

    def get(self, key: Any, default: Any = None) -> Any:
        """Return the value of a field, or the list of its values."""
        values = self.getlist(key)
        return values if len(values) > 1 else super().get(key, default)


class _Parts(MultiPartParser):
    """Parts of a form, each refused by its head before that is parsed."""

    def on_headers_finished(self) -> None:
        """Take the name of a part."""
        stated = self._current_part.content_disposition or b""
        if stated.count(b";") > MOST_SEMICOLONS:
            raise MultiPartException(
                f"more than {MOST_SEMICOLONS} semicolons in Content-Disposition"
            )
        super().on_headers_finished()


class StrictRequest(Request):
    """A request whose query, JSON or form is read whole and to the letter, or refused."""

    _last = b""  # what it has to end with

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
        return StrictQuery(current_parameters(pairs))

    async def body(self) -> bytes:
        """Return the body; a `Problem` (415, 413, 408) where it is no JSON, or too long."""
        self._largest = LARGEST_JSON
        self._require(JSON, "application/json in UTF-8")
        return await super().body() or self._parse(b"")  # which FastAPI would take for no body

    async def json(self) -> Any:
        """Return the parsed body: RFC 8259, so no NaN, no Infinity, and no member twice.

        Raises
        ------
        Problem
            As `body`, and 400 where it is not JSON.
        """
        document = self._parse(await self.body())
        if isinstance(document, dict):
            return {PARAMETERS.get(name, name): value for name, value in document.items()}
        return document

    async def form(self, **_: Any) -> FormData:  # type: ignore[override]  # awaited alone
        """Return the form (RFC 7578) in the body; its files wait on disk until all has come.

        Raises
        ------
        Problem
            415, 413, 408 as `body`, and 400 where it cannot be read or has a field twice.
        """
        self._largest = LARGEST_FORM
        self._last = b"--%s--" % self._require(FORM, f"{FORM} with a boundary")
        most = {"max_files": MOST_PARTS, "max_fields": MOST_PARTS, "max_part_size": LARGEST_FIELD}
        try:
            form = await _Parts(self.headers, self.stream(), **most).parse()
        except MultiPartException as error:
            raise _malformed(str(error.__cause__ or error)) from error
        named = [name for name, value in form.multi_items() if isinstance(value, str)]
        twice = next((name for name in named if named.count(name) > 1), None)
        if twice is not None:
            await form.close()
            raise _malformed(f"field {twice[:40]} stands twice")
        return form

    async def stream(self) -> AsyncGenerator[bytes, None]:
        """Yield the body; a `Problem` (413, 408) where it is too long or comes too slowly."""
        clock, chunks = asyncio.get_running_loop().time, super().stream()
        begun, length, end = clock(), 0, b""
        while True:
            left = begun + PATIENCE_S + length / SLOWEST_PER_S - clock()
            try:
                async with asyncio.timeout(left):
                    chunk = await anext(chunks, None)
            except TimeoutError as error:
                expected = f"at least {SLOWEST_PER_S} bytes/s after {PATIENCE_S:g} s"
                wrong = Violation("body", "fewer", expected)
                raise BodyProblem(408, "request-timeout", errors=[wrong]) from error
            if chunk is None and self._last not in end:
                raise MultiPartException("no boundary ends it")
            if chunk is None:
                return
            length += len(chunk)
            if length > self._largest:
                raise self._too_long(f"{length} or more")
            end = (end + chunk)[-_LONGEST_TYPE:]
            wait = _until_turn(len(chunk), clock())
            begun += wait
            await asyncio.sleep(wait)
            yield chunk

    def _require(self, media: str, expected: str) -> bytes:
        """Refuse a body by its headers, before it is read; return the boundary of a form."""
        stated = self.headers.get("content-type")
        if len(stated or "") > _LONGEST_TYPE:
            expected = f"{expected}, in at most {_LONGEST_TYPE} characters"
            raise _unsupported("Content-Type", stated, expected, {"Accept": media})
        kind, options = parse_options_header(stated)
        plain = options.get(b"charset", b"utf-8").lower() == b"utf-8"
        if kind != media.encode() or not plain or (media == FORM and b"boundary" not in options):
            raise _unsupported("Content-Type", stated, expected, {"Accept": media})
        coding = self.headers.get("content-encoding", "identity")
        if coding.strip().lower() not in {"", "identity"}:
            expected, headers = (
                "identity: bodies are not compressed",
                {"Accept-Encoding": "identity"},
            )
            raise _unsupported("Content-Encoding", coding, expected, headers)
        length = self.headers.get("content-length", "")
        if length.isdecimal() and int(length) > self._largest:
            raise self._too_long(length)
        return options.get(b"boundary", b"")

    def _parse(self, body: bytes) -> Any:
        try:
            return json.loads(
                body.decode("utf-8"), parse_constant=_refuse_constant, object_pairs_hook=_object
            )
        except (ValueError, RecursionError) as error:
            reason = "nested too deeply" if isinstance(error, RecursionError) else str(error)
            violation = Violation("body", None, f"JSON in UTF-8 ({reason})")
            raise BodyProblem(400, "malformed-json", errors=[violation]) from error

    def _too_long(self, came: str) -> BodyProblem:
        error = Violation("body", f"{came} bytes", f"at most {self._largest} bytes")
        return BodyProblem(413, "content-too-large", errors=[error])


_read_through = 0.0


def _until_turn(length: int, now: float) -> float:
    """Return seconds until so many bytes more have their turn, after those of all other bodies."""
    global _read_through  # noqa: PLW0603 - of the process
    _read_through = max(_read_through, now) + length / MOST_PER_S
    return _read_through - length / MOST_PER_S - now


def _unsupported(
    header: str, came: str | None, expected: str, headers: dict[str, str]
) -> BodyProblem:
    error = Violation(header, came, expected)
    return BodyProblem(415, "unsupported-media-type", errors=[error], headers=headers)


def _malformed(reason: str) -> BodyProblem:
    wrong = Violation("body", None, f"a form of RFC 7578 ({reason})")
    return BodyProblem(400, "malformed-form", errors=[wrong])


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not JSON")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    members = dict(pairs)
    if len(members) < len(pairs):
        raise ValueError("an object has a member twice")
    return members
