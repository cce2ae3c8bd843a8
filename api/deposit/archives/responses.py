"""The bytes of an archive's answer: so many packed and unpacked, and read as one kind of JSON."""

from __future__ import annotations

import re
import zlib
from typing import Any, TypeVar

import httpx
from pydantic import BaseModel, ValidationError

from api.deposit.archives.contract import ArchiveError

#: Bytes of an answer, as they come and unpacked; a list of a hundred files has a tenth of it.
LARGEST = 4 << 20
_CHUNK = 1 << 16
_JSON = re.compile(r"application/(?:[\w.+-]+\+)?json", re.IGNORECASE)

R = TypeVar("R", bound=BaseModel)


class ReplyError(ArchiveError):
    """An answer does not hold what the documentation promises."""


def read_response(answer: httpx.Response, largest: int = LARGEST) -> bytes:
    """Return the body of an answer that is being received.

    Parameters
    ----------
    answer : a stream, of which nothing has been read
    largest : bytes that it may have as they come, and unpacked

    Raises
    ------
    ReplyError
        Where it has more, or is packed by anything but gzip, or wrongly.
    httpx.HTTPError
        Where the connection breaks.
    """
    packing = answer.headers.get("Content-Encoding", "").strip().lower()
    if packing not in {"", "identity", "gzip", "x-gzip"}:
        raise ReplyError(f"packed as {packing[:40]!r}, expected gzip or no packing")
    unpacker = zlib.decompressobj(wbits=31) if "gzip" in packing else None
    came, found = 0, bytearray()
    for chunk in answer.iter_raw(_CHUNK):
        came += len(chunk)
        if unpacker is None:
            found += chunk
        else:
            try:
                found += unpacker.decompress(chunk, largest + 1 - len(found))
            except zlib.error as error:
                raise ReplyError("not gzip, though it says so") from error
        if max(came, len(found)) > largest:
            raise ReplyError(f"more than {largest:,} bytes, expected fewer")
    if unpacker is not None and (not unpacker.eof or unpacker.unused_data):
        raise ReplyError("gzip that is cut short or goes on behind its end")
    return bytes(found)


def holds_json(answer: httpx.Response) -> bool:
    """Say whether an answer calls itself JSON in UTF-8."""
    kind, *rest = (part.strip() for part in answer.headers.get("Content-Type", "").split(";"))
    charsets = [part.partition("=")[2].strip('"').lower() for part in rest if "charset" in part]
    return bool(_JSON.fullmatch(kind)) and set(charsets) <= {"utf-8", "utf8", "us-ascii"}


def parse_response(answer: httpx.Response, body: bytes, expected: type[R]) -> R:
    """Return what an answer holds.

    Raises
    ------
    ReplyError
        Where it is no JSON, or lacks a member or has one of another type; members that nobody
        asks for may be there.
    """
    if not holds_json(answer):
        kind = answer.headers.get("Content-Type", "")[:80] or "no content type"
        raise ReplyError(f"{kind}, expected application/json in UTF-8")
    try:
        return expected.model_validate_json(body)
    except ValidationError as error:
        raise ReplyError(f"{_first(error)}; expected {_said(expected)}") from error


def _first(error: ValidationError) -> str:
    """Say what the first thing is that does not fit."""
    first = error.errors(include_url=False)[0]
    where = ".".join(map(str, first["loc"])) or "the whole"
    if first["type"] == "json_invalid":
        return f"no JSON ({first['ctx']['error']})"
    if first["type"] == "missing":
        return f"no {where}"
    reason = first["msg"].removeprefix("Value error, ")
    return f"{where} is {short(first['input'])} ({reason[:1].lower()}{reason[1:]})"


def _said(expected: type[BaseModel]) -> str:
    """Return the noun with which a model's docstring begins."""
    noun = (expected.__doc__ or "").partition(":")[0].strip()
    return f"{noun[:1].lower()}{noun[1:]}"


def short(value: Any) -> str:
    """Return a value of an answer as text of at most 80 letters."""
    try:
        return repr(value)[:80]
    except ValueError:  # a whole number of more digits than Python writes
        return "a number of thousands of digits"
