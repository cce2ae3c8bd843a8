"""Pages of a list: opaque cursors and the Link header."""

from __future__ import annotations

import base64
import binascii
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from api.http.parameters import Arguments, Parameter, Parameters
from api.http.problems import Problem, Violation
from api.http.values import Integer, Text

Row = TypeVar("Row")

LARGEST_PAGE = 500
DEFAULT_PAGE = 200

LIMIT = Parameter(
    "limit",
    Integer(1, LARGEST_PAGE),
    "Items on a page.",
    default=DEFAULT_PAGE,
)
CURSOR = Parameter(
    "cursor",
    Text(200),
    "Where to go on: the `next` of the previous page, unchanged and with the same filters.",
)


@dataclass(frozen=True)
class Page(Generic[Row]):
    """Some rows of a list, how many the list has, and where it goes on.

    Attributes
    ----------
    items : the rows of this page
    total : number of rows of the whole list
    next : cursor of the next page; None on the last one
    link : value of the Link header; None on the last page
    """

    items: Sequence[Row]
    total: int
    next: str | None
    link: str | None


def page(rows: Sequence[Row], path: str, parameters: Parameters, arguments: Arguments) -> Page[Row]:
    """Return the page of `rows` that `arguments` ask for.

    A cursor is bound to the path and the filters it was given out for.

    Raises
    ------
    Problem
        400 where the cursor was not given out for this list.
    """
    filters = {**arguments, "cursor": None, "limit": DEFAULT_PAGE}
    bound_to = hashlib.blake2b(
        f"{path}?{parameters.canonical(filters)}".encode(), digest_size=6
    ).hexdigest()
    start = 0 if arguments["cursor"] is None else _offset(arguments["cursor"], bound_to)
    end = start + arguments["limit"]
    if end >= len(rows):
        return Page(rows[start:], len(rows), None, None)
    cursor = _cursor(end, bound_to)
    target = f"{path}?{parameters.canonical({**arguments, 'cursor': cursor})}"
    return Page(rows[start:end], len(rows), cursor, f'<{target}>; rel="next"')


def _cursor(offset: int, bound_to: str) -> str:
    text = json.dumps([offset, bound_to], separators=(",", ":"))
    return base64.urlsafe_b64encode(text.encode()).decode().rstrip("=")


def _offset(cursor: str, bound_to: str) -> int:
    try:
        padded = cursor + "=" * (-len(cursor) % 4)
        offset, bound = json.loads(base64.b64decode(padded.encode(), b"-_", validate=True))
    except (binascii.Error, ValueError, TypeError, RecursionError):
        offset, bound = None, None
    # Written again and compared: one cursor a place, no second spelling.
    if not isinstance(offset, int) or bound != bound_to or _cursor(offset, bound_to) != cursor:
        expected = "the next of an answer to this path with these filters"
        raise Problem(400, "invalid-cursor", errors=[Violation("cursor", cursor, expected)])
    return offset
