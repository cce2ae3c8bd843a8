"""What an archive says of why it refuses: its message and the fields that it names."""

from __future__ import annotations

from typing import Any

import httpx

from api.deposit.archives.replies import Reply
from api.deposit.archives.responses import ReplyError, parse_response


class _Reason(Reply):
    field: str | None = None
    message: str | None = None
    messages: list[str] | None = None


class Refusal(Reply):
    """A message, and errors with their fields: of a refusal."""

    message: str | None = None
    errors: list[_Reason] | None = None


def reasons(answer: httpx.Response, body: bytes) -> str:
    """Return the reasons in a refusal as one text; where they cannot be read, that they cannot."""
    if not body:
        return ""
    try:
        refusal = parse_response(answer, body, Refusal)
    except ReplyError as error:
        return f"its reasons cannot be read: {error}"
    parts: list[Any] = [refusal.message]
    for reason in refusal.errors or ():
        said = " ".join(reason.messages or ()) or reason.message
        parts.append(f"{reason.field or 'a field'}: {said}" if said else reason.field)
    return "; ".join(part for part in parts if part)
