"""Which edition a page shows, and the address of the same page with the other."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import parse_qsl, urlencode

from fastapi import Request

from api.service.knowledge import Knowledge
from survey_data.editions import Choice


@dataclass(frozen=True)
class EditionShown:
    """How many studies the survey maps, how many it does not, and which of them a page shows.

    ``later`` of those that it does not map are after its last year, ``last_year``. ``other`` is the
    address of the page with the other choice.
    """

    survey: int
    unmapped: int
    later: int
    last_year: int
    all: bool
    other: str


def edition_shown(known: Knowledge, edition: Choice, request: Request) -> EditionShown:
    """Return what a page says of the edition that it shows."""
    survey, added = known.editions
    asked = parse_qsl(request.scope["query_string"].decode("latin-1"))
    fields = [(name, value) for name, value in asked if name != "edition"]
    if edition == "survey":
        fields.append(("edition", "all"))
    path = request.scope["path"]
    other = f"{path}?{urlencode(fields)}" if fields else path
    return EditionShown(
        survey=survey.studies,
        unmapped=added.studies,
        later=added.later,
        last_year=survey.last_year,
        all=edition == "all",
        other=other,
    )
