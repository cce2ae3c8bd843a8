"""What is read of an archive's answers: required members, identifiers and checksums.

More members than are read may be there; one that is missing or of another type is named.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

from api.deposit.archives.contract import ArchiveError, RefusedError
from api.deposit.archives.transport import Content

_IDENTIFIER = re.compile(r"[A-Za-z0-9][A-Za-z0-9-]{0,63}")
_MD5 = re.compile(r"(?:md5:)?([0-9a-f]{32})")
_CHUNK = 1 << 20


class ReplyError(ArchiveError):
    """An answer does not hold what the documentation promises."""


def member(reply: Any, *names: str) -> Any:
    """Return the member of an answer under these names, one within the other."""
    found = reply
    for name in names:
        if not isinstance(found, Mapping) or name not in found:
            raise ReplyError(f"the archive's answer has no {'.'.join(names)}; got {_short(reply)}")
        found = found[name]
    return found


def entries(reply: Any, what: str) -> list[Any]:
    """Return a list of an answer, as it is."""
    if not isinstance(reply, list):
        raise ReplyError(f"expected the archive to list {what}; got {_short(reply)}")
    return reply


def identifier(value: Any) -> str:
    """Return the identifier of a record, as text that may stand in an address.

    Raises
    ------
    ReplyError
        For anything else.
    """
    text = str(value)
    if isinstance(value, bool) or not _IDENTIFIER.fullmatch(text):
        raise ReplyError(
            f"{text[:80]!r} is no identifier of a record: expected letters and digits, as in "
            "the record's address"
        )
    return text


def md5(value: Any) -> str | None:
    """Return a checksum in hexadecimal, with or without its prefix; None where there is none."""
    found = _MD5.fullmatch(value) if isinstance(value, str) else None
    return found[1] if found else None


def segment(name: str) -> str:
    """Return a file's name as one segment of a path."""
    return quote(name, safe="")


def content(path: Path) -> Content:
    """Return a file as the body of a request, read again for each try."""

    def chunks() -> Iterable[bytes]:
        with path.open("rb") as file:
            while chunk := file.read(_CHUNK):
                yield chunk

    return Content(chunks, path.stat().st_size)


def unless_missing(look: Callable[[], Any]) -> Any:
    """Look at something; None where the archive says that it is not there (404, 410)."""
    try:
        return look()
    except RefusedError as error:
        if error.status in {404, 410}:
            return None
        raise


def _short(reply: Any) -> str:
    return repr(reply)[:120]
