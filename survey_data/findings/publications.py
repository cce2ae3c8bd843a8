"""How many of the mapped studies were published in each year and at each venue."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Literal

from survey_data.tables import SurveyTables


@dataclass(frozen=True)
class Publications:
    """Studies of a year, or of a venue; those whose venue is not known are in no venue."""

    kind: Literal["year", "venue"]
    value: str
    studies: int


def publications(tables: SurveyTables) -> tuple[Publications, ...]:
    """Count the studies per year, years in order, then per venue, those with most first.

    The survey prints the first as a figure, and refers for the second to its own data set.
    """
    years = Counter(str(year) for year in tables.studies["year"])
    venues = Counter(str(venue) for venue in tables.venues["venue"])
    return (
        *(Publications("year", year, count) for year, count in sorted(years.items())),
        *(
            Publications("venue", venue, count)
            for venue, count in sorted(venues.items(), key=lambda item: (-item[1], item[0]))
        ),
    )
