"""The survey's statements about algorithms, put to the test."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from api import columns
from api.http.models.base import Listing, Shape, TableQuestion
from api.http.models.parameters import (
    DEFAULT_PAGE,
    FIELDS,
    GIVEN,
    SORT,
    Cursor,
    Limit,
    Several,
    columns_of,
    several,
    sorting,
)
from api.http.models.words import ClaimVerdict

Standing = Literal["holds", "fails", "open"]


class ClaimsQuery(TableQuestion):
    """Which claims."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"q": "polynomial order"}]})

    verdict: Several[ClaimVerdict] = several("Only claims with this verdict.")
    q: Annotated[
        str | None,
        Field(
            min_length=1,
            max_length=200,
            description="Words, all of which stand in the claim, its study or its section.",
        ),
        GIVEN,
    ] = None
    sort: Annotated[str | None, sorting(columns.CLAIMS), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.CLAIMS)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class ClaimRule(Shape):
    """One thing that has to hold for a claim."""

    rule: str
    statistic: str = Field(description="What is computed in every trial.")
    decides: str = Field(description="What the statistic has to be for the rule to hold.")
    standing: Standing = Field(
        description="Holds or fails where the whole interval is on one side; open between."
    )
    estimate: float | None = Field(description="Mean over the trials; of ratios the geometric one.")
    low: float | None = Field(description="Lower end of the 95 % interval of the mean.")
    high: float | None = Field(description="Upper end.")
    trials: int = Field(description="Trials that gave a number.")
    timed: bool = Field(description="A ratio of run times, which differs from run to run.")


class Claim(Shape):
    """One statement of the survey, and what came out."""

    id: str
    section: str = Field(description="Label in the survey's source.")
    section_name: str = Field(description="What the label names, with its number in print.")
    study: str = Field(description="Key of the study that the survey cites; empty for none.")
    statement: str
    verdict: str | None = Field(
        description="Reproduced where every rule holds, partly where some do, refuted where none "
        "does and one fails, not testable here where all are open; null where not measured."
    )
    explanation: str = Field(description="Why it is not so, or what to read it with.")
    measured_on: str = Field(description="Data, sensors and methods.")
    trials: int = Field(description="Planned.")
    replicate: Literal["unit", "seed"] = Field(
        description="What differs between trials: the unit of the sensor, or the random draws."
    )
    rules: list[ClaimRule]
    second_method: str = Field(description="The other method it was checked by; empty for none.")
    second_agrees: bool | None = Field(description="Whether it says the same of every rule.")
    second: list[ClaimRule] = Field(description="The rules by that method.")


class Claims(Listing):
    """A page of claims."""

    items: list[Claim]
    tally: dict[str, int] = Field(description="Claims by verdict, of the whole list.")


class ClaimLine(Shape):
    """A line of the claim's plot."""

    across: list[float | str] = Field(description="Places.")
    median: list[float | None] = Field(description="Of the trials.")
    low: list[float | None] = Field(description="Smallest of the trials.")
    high: list[float | None] = Field(description="Largest of the trials.")


class ClaimDetail(Claim):
    """One claim with every number of its trials."""

    how_to_test: str = Field(description="As the claim was taken from the survey.")
    values: dict[str, list[float | None]] = Field(description="By rule, a number a trial.")
    second_values: dict[str, list[float | None]]
    across: str = Field(description="What the plot's places are.")
    up: str = Field(description="What the plot's values are.")
    lines: dict[str, ClaimLine]
