"""Reading a request more strictly than Starlette does, within bounds."""

from __future__ import annotations

import json
from functools import cached_property
from typing import Any, NoReturn
from urllib.parse import parse_qsl

from starlette.datastructures import QueryParams
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request

from api.service.problems import Problem, Violation

MOST_FIELDS = 500  # of one query
LARGEST_BODY = 64 * 1024  # bytes; the longest sensible set of requirements is a twentieth of it

LARGEST_READ = 16 * 2**20  # bytes of a refused body that are read


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

    _read: bytes | None = None

    @cached_property  # FastAPI reads it once a dependency
    def query_params(self) -> StrictQuery:
        """The query.

        Raises
        ------
        Problem
            400 where it cannot be read.
        """
        query: bytes = self.scope["query_string"]
        if not query:
            return StrictQuery()
        try:
            pairs = parse_qsl(
                query.decode("ascii"),
                keep_blank_values=True,
                strict_parsing=True,
                errors="strict",
                max_num_fields=MOST_FIELDS,
            )
        except ValueError as error:
            expected = f"at most {MOST_FIELDS} fields name=value joined by &, percent-encoded UTF-8"
            violation = Violation("query", query.decode("latin-1"), expected)
            raise Problem(400, "malformed-query", errors=[violation]) from error
        return StrictQuery(pairs)

    async def body(self) -> bytes:
        """Return the body.

        Raises
        ------
        Problem
            415 where it is said to be something else than JSON in UTF-8, 413 where it is too long,
            400 where it is empty.
        """
        if self._read is not None:
            return self._read
        self._require_json()
        self._refuse_at_once()
        chunks: list[bytes] = []
        length = 0
        try:
            async for chunk in self.stream():
                length += len(chunk)
                # What is too long is read all the same, and thrown away: a connection closed on
                # a client that is still sending would take the refusal with it.
                if length > LARGEST_READ:
                    break
                if length <= LARGEST_BODY:
                    chunks.append(chunk)
        except ClientDisconnect as error:
            violation = Violation("body", f"{length} bytes", "all that its length promised")
            raise BodyProblem(400, "incomplete-body", errors=[violation]) from error
        if length > LARGEST_BODY:
            came = f"{length} bytes or more"
            violation = Violation("body", came, f"at most {LARGEST_BODY} bytes")
            raise BodyProblem(413, "content-too-large", errors=[violation])
        self._read = b"".join(chunks) or self._parse(b"")  # which FastAPI would take for no body
        return self._read

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

    def _refuse_at_once(self) -> None:
        """Refuse a body that is too long before it is sent, where the client asks first."""
        length = self.headers.get("content-length", "")
        asks = self.headers.get("expect", "").lower() == "100-continue"
        if asks and length.isascii() and length.isdigit() and int(length) > LARGEST_BODY:
            error = Violation("body", f"{length} bytes", f"at most {LARGEST_BODY} bytes")
            headers = {"Connection": "close"}
            raise BodyProblem(413, "content-too-large", errors=[error], headers=headers)

    def _require_json(self) -> None:
        content_type = self.headers.get("content-type")
        media, *arguments = (part.strip().lower() for part in (content_type or "").split(";"))
        charsets = [a.partition("=")[2].strip('"') for a in arguments if a[:8] == "charset="]
        if media != "application/json" or any(charset != "utf-8" for charset in charsets):
            error = Violation("Content-Type", content_type, "application/json in UTF-8")
            raise BodyProblem(
                415,
                "unsupported-media-type",
                errors=[error],
                headers={"Accept": "application/json"},
            )
        coding = self.headers.get("content-encoding", "identity")
        if coding.strip().lower() not in {"", "identity"}:
            error = Violation("Content-Encoding", coding, "identity: bodies are not compressed")
            raise BodyProblem(
                415,
                "unsupported-media-type",
                errors=[error],
                headers={"Accept-Encoding": "identity"},
            )


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not JSON")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    members = dict(pairs)
    if len(members) < len(pairs):
        raise ValueError("an object has a member twice")
    return members
