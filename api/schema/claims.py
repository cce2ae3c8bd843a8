"""The survey's statements about algorithms, put to the test."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from api.schema.base import Listing, Shape, SortedQuestion, example
from api.schema.parameters import GIVEN, Several, several
from api.schema.words import ClaimVerdict

RuleResult = Literal["holds", "fails", "open"]
VERDICT = Field(
    description="refuted: no criterion holds on the sentence's own case; not reproduced here: "
    "none holds on another; null: not measured."
)
MEASURED_ON = Field(description="Data, sensors and methods.")


class ClaimRule(Shape):
    """A criterion of a claim."""

    rule: str
    statistic: str = Field(description="Statistic of every trial.")
    decides: str = Field(description="Threshold of the statistic.")
    result: RuleResult = Field(description="open: the 95 % interval includes the threshold.")
    estimate: float | None = Field(description="Mean over the trials; geometric mean for ratios.")
    low: float | None = Field(description="Lower end of the 95 % interval.")
    high: float | None = Field(description="Upper end of the 95 % interval.")
    trials: int = Field(description="Trials with a result.")
    timed: bool = Field(description="Is it a ratio of run times?")


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
    verdict: str | None = VERDICT
    trials: int = Field(description="Planned trials.")
    explanation: str = Field(description="Remarks on the verdict.")
    case: str = Field(description="Is the trial the sentence's case?")


class Claim(ClaimRow):
    """A claim with its verdict."""

    measured_on: str = MEASURED_ON
    replicate: Literal["unit", "seed"] = Field(description="What differs between trials.")
    rules: list[ClaimRule] = Field(description="Criteria.")
    second_method: str = Field(description="Second method; empty for none.")
    second_agrees: bool | None = Field(description="Whether it agrees.")
    second: list[ClaimRule] = Field(description="Results by the second method.")


class Claims(Listing):
    """A page of claims."""

    items: list[Claim]
    tally: dict[str, int] = Field(description="Claims by verdict, of the whole list.")


class ClaimLine(Shape):
    """A line of a claim's plot."""

    x: list[float | str] = Field(description="Horizontal positions.")
    median: list[float | None] = Field(description="Median of the trials.")
    low: list[float | None] = Field(description="Minimum of the trials.")
    high: list[float | None] = Field(description="Maximum of the trials.")


class FormerOutcome(Shape):
    """An outcome before a change."""

    measured_on: str = MEASURED_ON
    verdict: str | None = VERDICT
    rules: list[ClaimRule] = Field(description="Criteria.")


class ClaimDetail(Claim):
    """A claim in full."""

    sentence: str = Field(description="The survey's sentence.")
    line: int = Field(description="Its line.")
    reason: str = Field(description="Reason of the case.")
    former: list[FormerOutcome] = Field(description="Former outcomes, oldest first.")
    how_to_test: str = Field(description="Test plan.")
    values: dict[str, list[float | None]] = Field(description="By criterion and trial.")
    second_values: dict[str, list[float | None]] = Field(description="The same, second method.")
    x_label: str = Field(description="Horizontal axis.")
    y_label: str = Field(description="Vertical axis.")
    lines: dict[str, ClaimLine] = Field(description="Lines of the plot, by name.")


class ClaimsQuery(SortedQuestion, rows=ClaimRow):
    """Which claims."""

    model_config = example(q="polynomial order")

    verdict: Several[ClaimVerdict] = several("Only claims with this verdict.")
    q: Annotated[
        str | None,
        Field(min_length=1, max_length=200, description="Words in claim, study or section."),
        GIVEN,
    ] = None
