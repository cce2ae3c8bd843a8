"""Pages of a list: opaque cursors and the Link header."""

from __future__ import annotations

import base64
import binascii
import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar
from urllib.parse import urlencode

from api.cells import cell
from api.schema.base import Paged, Question
from api.schema.table import flat
from api.service.problems import Problem, Violation

Row = TypeVar("Row")

SHOWN_BY = {"limit", "cursor", "format", "fields", "safe", "whole"}
"""Parameters that do not change which items a list has, or their order."""


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


def narrow(
    rows: Iterable[Mapping[str, Any]], query: Question, names: Sequence[str]
) -> list[Mapping[str, Any]]:
    """Return the rows that have one of the wanted words of every field that is narrowed."""
    wanted = {name: words for name in names if (words := getattr(query, name))}
    return [row for row in rows if all(row[name] in words for name, words in wanted.items())]


def order(rows: Sequence[Mapping[str, Any]], sort: str | None) -> list[Mapping[str, Any]]:
    """Return rows by a column, or from its largest value down with "-" before its name.

    Rows without a value (None, NaN, empty text) come last either way; equal ones keep their order.
    """
    if sort is None:
        return list(rows)
    name = sort.removeprefix("-")
    values = [(flat(row, (name,))[name], row) for row in rows]
    there = [pair for pair in values if cell(pair[0])]
    missing = [row for value, row in values if not cell(value)]
    there.sort(key=lambda pair: _key(pair[0]), reverse=sort != name)
    return [row for _, row in there] + missing


def _key(value: Any) -> Any:
    return value.casefold() if isinstance(value, str) else value


def page(rows: Sequence[Row], path: str, query: Paged) -> Page[Row]:
    """Return the page of `rows` that a query asks for.

    A cursor is bound to the path and the filters it was given out for.

    Raises
    ------
    Problem
        400 where the cursor was not given out for this list.
    """
    asked = query.model_dump(exclude_defaults=True)
    filters = {name: value for name, value in asked.items() if name not in SHOWN_BY}
    bound_to = hashlib.blake2b(f"{path}?{_encode(filters)}".encode(), digest_size=6).hexdigest()
    start = 0 if query.cursor is None else _offset(query.cursor, bound_to)
    end = start + query.limit
    if end >= len(rows):
        return Page(rows[start:], len(rows), None, None)
    cursor = _cursor(end, bound_to)
    target = f"{path}?{_encode({**asked, 'cursor': cursor})}"
    return Page(rows[start:end], len(rows), cursor, f'<{target}>; rel="next"')


def _encode(asked: Mapping[str, Any]) -> str:
    """Return the one query string that means what is asked; lists are sorted already."""
    return urlencode(asked, doseq=True)


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
