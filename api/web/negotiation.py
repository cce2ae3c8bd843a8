"""Which representation a request accepts: media type and content coding."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from urllib.parse import parse_qsl

from pydantic import TypeAdapter, ValidationError

from api.service.problems import Problem, Violation

JSON = "application/json"
CSV = "text/csv"
PNG = "image/png"
PARQUET = "application/vnd.apache.parquet"
BIBTEX = "application/x-bibtex"
RIS = "application/x-research-info-systems"
CSL = "application/vnd.citationstyles.csl+json"
CITATIONS = {"bibtex": BIBTEX, "ris": RIS, "csl": CSL}
FORMATS = {"json": JSON, "csv": CSV, **CITATIONS}
"""What `format` in a query calls them."""
CONTENT_TYPES = {
    JSON: "application/json",
    CSV: "text/csv; charset=utf-8; header=present",
    BIBTEX: f"{BIBTEX}; charset=utf-8",
    RIS: f"{RIS}; charset=utf-8",
    CSL: CSL,
}

_YES = TypeAdapter(bool)
_QUALITY = re.compile(r"(?:0(?:\.\d{0,3})?|1(?:\.0{0,3})?)\Z")


def preferences(header: str) -> list[tuple[str, float]]:
    """Return the ranges of an Accept-like header with their weights, in the order given.

    A range whose weight is not a weight (RFC 9110, 12.4.2) is left out, as if it were not there.
    """
    ranges = []
    for part in header.split(","):
        name, *arguments = (piece.strip() for piece in part.split(";"))
        if not name:
            continue
        weight = 1.0
        for argument in arguments:
            key, _, value = argument.partition("=")
            if key.strip().lower() == "q":
                value = value.strip()
                weight = float(value) if _QUALITY.match(value) else -1.0
        if weight >= 0.0:
            ranges.append((name.lower(), weight))
    return ranges


def _weight(media_type: str, accepted: Sequence[tuple[str, float]]) -> float:
    """Return the weight of a media type: the most specific range that covers it decides."""
    group = media_type.partition("/")[0] + "/*"
    for wanted in (media_type, group, "*/*"):
        weights = [weight for name, weight in accepted if name == wanted]
        if weights:
            return max(weights)
    return 0.0


@lru_cache(256)
def media_type(accept: str | None, offered: tuple[str, ...]) -> str:
    """Return the offered media type the client likes best; the first offered wins a tie.

    Raises
    ------
    Problem
        406 where the client accepts none of those offered.
    """
    if accept is None or not accept.strip():
        return offered[0]
    accepted = preferences(accept)
    weight, chosen = max(
        ((_weight(name, accepted), name) for name in offered), key=lambda pair: pair[0]
    )
    if weight <= 0.0:
        error = Violation("Accept", accept, f"one of {', '.join(offered)}")
        raise Problem(406, "not-acceptable", errors=[error])
    return chosen


def wanted_type(query: bytes, accept: str | None, offered: tuple[str, ...]) -> str:
    """Return the offered media type that a request wants: `format` of its query, else `Accept`.

    A `format` that is none, or is given twice, is for the parameters to refuse.

    Raises
    ------
    Problem
        406 where the client accepts none of those offered, or not the one that it asks for.
    """
    # A name may be percent-encoded.
    if b"format" in query or b"%" in query:
        pairs = _pairs(query)
        asked = [value for name, value in pairs if name == "format"]
        form = FORMATS.get(asked[0]) if len(asked) == 1 else None
        if form in offered:
            if accept is not None and accept.strip() and _weight(form, preferences(accept)) <= 0.0:
                error = Violation("format", asked[0], f"what Accept takes, which is {accept}")
                raise Problem(406, "not-acceptable", errors=[error])
            return form
    return media_type(accept, offered)


def for_spreadsheets(query: bytes) -> bool:
    """Say whether a query asks for CSV that a spreadsheet can open (`safe`).

    Raises
    ------
    Problem
        422 where it neither asks for it nor does not.
    """
    if b"safe" not in query and b"%" not in query:
        return False
    asked = [value for name, value in _pairs(query) if name == "safe"]
    try:
        return all(map(_YES.validate_python, asked)) and bool(asked)
    except ValidationError as error:
        wrong = Violation("safe", ", ".join(asked), "true or false")
        raise Problem(422, "invalid-value", errors=[wrong]) from error


def _pairs(query: bytes) -> list[tuple[str, str]]:
    return parse_qsl(query.decode("latin-1"), keep_blank_values=True)


@lru_cache(256)
def accepts_gzip(accept_encoding: str | None) -> bool:
    """Say whether the client takes gzip, and does not like the bare bytes better."""
    if not accept_encoding:
        return False
    weights = dict(preferences(accept_encoding))
    gzip = weights.get("gzip", weights.get("x-gzip", weights.get("*", 0.0)))
    return gzip > 0.0 and gzip >= weights.get("identity", 0.0)
