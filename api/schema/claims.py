"""The survey's statements about algorithms, put to the test."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from api.schema.base import Listing, Shape, SortedQuestion
from api.schema.parameters import (
    GIVEN,
    Several,
    several,
)
from api.schema.words import ClaimVerdict

RuleResult = Literal["holds", "fails", "open"]


class ClaimRule(Shape):
    """A criterion of a claim."""

    rule: str
    statistic: str = Field(description="Statistic computed in every trial.")
    decides: str = Field(description="Threshold of the statistic.")
    result: RuleResult = Field(
        description=(
            "holds or fails: the 95 % interval is on one side of the threshold; open: it "
            "includes the threshold."
        )
    )
    estimate: float | None = Field(description="Mean over the trials; geometric mean for ratios.")
    low: float | None = Field(description="Lower end of the 95 % interval of the mean.")
    high: float | None = Field(description="Upper end of the 95 % interval of the mean.")
    trials: int = Field(description="Number of trials with a result.")
    timed: bool = Field(description="Whether it is a ratio of run times.")


class CheckedRule(ClaimRule):
    """A criterion with what the second method says of it: a row of the table."""

    second_result: RuleResult | None = Field(description="The result by the second method.")


class ClaimRow(Shape):
    """A statement of the survey with its verdict: a row of the table."""

    id: str
    section: str = Field(description="Label in the survey's source.")
    section_name: str = Field(description="Name of the section, with printed number.")
    study: str = Field(description="Key of the study that the survey cites; empty for none.")
    statement: str = Field(description="The survey's statement.")
    verdict: str | None = Field(
        description=(
            "reproduced: every criterion holds; partly: some hold; refuted: none holds "
            "and at least one fails; not testable here: all undecided; null: not "
            "measured."
        )
    )
    trials: int = Field(description="Number of planned trials.")
    explanation: str = Field(description="Explanation of the verdict, or remarks.")


class Claim(ClaimRow):
    """A statement of the survey with its verdict."""

    measured_on: str = Field(description="Data, sensors and methods.")
    replicate: Literal["unit", "seed"] = Field(description="What differs between trials.")
    rules: list[ClaimRule] = Field(description="Criteria that decide the claim.")
    second_method: str = Field(description="Second method of the check; empty if none.")
    second_agrees: bool | None = Field(description="Whether all its verdicts are the same.")
    second: list[ClaimRule] = Field(description="Results of the criteria by the second method.")


class Claims(Listing):
    """A page of claims."""

    items: list[Claim]
    tally: dict[str, int] = Field(description="Claims by verdict, of the whole list.")


class ClaimLine(Shape):
    """A line of a claim's plot."""

    across: list[float | str] = Field(description="Positions on the horizontal axis.")
    median: list[float | None] = Field(description="Median of the trials.")
    low: list[float | None] = Field(description="Minimum of the trials.")
    high: list[float | None] = Field(description="Maximum of the trials.")


class ClaimDetail(Claim):
    """A claim with the results of all trials."""

    how_to_test: str = Field(description="Test method, stated before measuring.")
    values: dict[str, list[float | None]] = Field(description="Statistic by trial and criterion.")
    second_values: dict[str, list[float | None]] = Field(description="The same, second method.")
    across: str = Field(description="Quantity on the horizontal axis.")
    up: str = Field(description="Quantity on the vertical axis.")
    lines: dict[str, ClaimLine] = Field(description="Lines of the plot, by name.")


class ClaimsQuery(SortedQuestion, rows=ClaimRow):
    """Which claims."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"q": "polynomial order"}]})

    verdict: Several[ClaimVerdict] = several("Only claims with this verdict.")
    q: Annotated[
        str | None,
        Field(
            min_length=1,
            max_length=200,
            description="Search words; all must occur in the claim, its study or its section.",
        ),
        GIVEN,
    ] = None
