"""Which media type a request accepts."""

from __future__ import annotations

import re
from functools import lru_cache
from urllib.parse import parse_qsl

from pydantic import TypeAdapter, ValidationError

from api.service.problems import Problem, Violation

JSON = "application/json"
CSV = "text/csv"
PNG = "image/png"
SVG = "image/svg+xml"
PLOTLY = "application/vnd.plotly.v1+json"
PARQUET = "application/vnd.apache.parquet"
BIBTEX = "application/x-bibtex"
RIS = "application/x-research-info-systems"
CSL = "application/vnd.citationstyles.csl+json"
CITATIONS = {"bibtex": BIBTEX, "ris": RIS, "csl": CSL}
FORMATS = {"json": JSON, "csv": CSV, "plotly": PLOTLY, **CITATIONS}
"""What `format` in a query calls them."""
CONTENT_TYPES = {
    CSV: "text/csv; charset=utf-8; header=present",
    BIBTEX: f"{BIBTEX}; charset=utf-8",
    RIS: f"{RIS}; charset=utf-8",
    CSL: CSL,
}
_YES = TypeAdapter(bool)
_QUALITY = re.compile(r"(?:0(?:\.\d{0,3})?|1(?:\.0{0,3})?)\Z")


@lru_cache(256)
def _weights(accept: str) -> dict[str, float]:
    """Return the ranges of an Accept header with their weights.

    A range whose weight is none (RFC 9110, 12.4.2) is left out, as if it were not there.
    """
    weights: dict[str, float] = {}
    for part in accept.lower().split(","):
        name, *arguments = (piece.strip() for piece in part.split(";"))
        pairs = [one.partition("=") for one in arguments]
        weight = next((value.strip() for key, _, value in pairs if key.strip() == "q"), "1")
        if _QUALITY.match(weight):
            weights[name] = max(float(weight), weights.get(name, 0.0))
    return weights


def _weight(media_type: str, accept: str | None) -> float:
    """Return the weight of a media type: the most specific range that covers it decides."""
    if accept is None or not accept.strip():
        return 1.0
    ranges = (media_type, media_type.partition("/")[0] + "/*", "*/*")
    return next((_weights(accept)[one] for one in ranges if one in _weights(accept)), 0.0)


def media_type(accept: str | None, offered: tuple[str, ...]) -> str:
    """Return the offered media type the client likes best; the first offered wins a tie.

    Raises
    ------
    Problem
        406 where the client accepts none of those offered.
    """
    chosen = max(offered, key=lambda name: _weight(name, accept))
    if _weight(chosen, accept) <= 0.0:
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
    asked = _given(query, "format")
    form = FORMATS.get(asked[0]) if len(asked) == 1 else None
    if form not in offered:
        return media_type(accept, offered)
    if _weight(form, accept) <= 0.0:
        error = Violation("format", asked[0], f"what Accept takes, which is {accept}")
        raise Problem(406, "not-acceptable", errors=[error])
    return form


def for_spreadsheets(query: bytes) -> bool:
    """Say whether a query asks for CSV that a spreadsheet can open (`safe`).

    Raises
    ------
    Problem
        422 where it neither asks for it nor does not.
    """
    asked = _given(query, "safe")
    try:
        return all(map(_YES.validate_python, asked)) and bool(asked)
    except ValidationError as error:
        wrong = Violation("safe", ", ".join(asked), "true or false")
        raise Problem(422, "invalid-value", errors=[wrong]) from error


def _given(query: bytes, wanted: str) -> list[str]:
    pairs = parse_qsl(query.decode("latin-1"), keep_blank_values=True)
    return [value for name, value in pairs if name == wanted]
