"""Which studies are asked for, and what is said of them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from api.schema import words
from api.schema.base import (
    CitedQuestion,
    OfEdition,
    Shape,
    SortedQuestion,
    TableQuestion,
    example,
    page_of,
)
from api.schema.parameters import GIVEN, WHOLE, Several, several
from api.schema.table import AS_TEXT, ColumnEach
from registry.fidelity.particulars import Purpose
from registry.fidelity.runnable import Part
from registry.sensors import Basis
from registry.taxonomy import ATTRIBUTES

REPORTED = ("accuracy_deg", "accuracy_kind", "precision_deg", "precision_kind", "fov_deg")
"""Attributes of studies that are numbers, and the statistics of these."""
State = Literal["complete", "partial", "none"]
Grade = Literal["faithful", "assumed", "close", "stand-in", "none"]


def _filter(attribute: str, more: str = "") -> Any:
    return several(f"Only studies with one of these values of {attribute}{more}.")


class StudyFilters(OfEdition, TableQuestion):
    """Filters by edition and by the attributes of studies."""

    task: Several[words.Task] = _filter("task")
    error: Several[words.Error] = _filter("error")
    accuracy: Several[words.Accuracy] = _filter("accuracy")
    detector: Several[words.Detector] = _filter("detector")
    mask: Several[words.Mask] = _filter("mask")
    model: Several[words.Model] = _filter("model", " (a parent such as ECM covers its kinds)")
    extractor: Several[words.Extractor] = _filter("extractor")

    def by_attribute(self) -> dict[str, list[str]]:
        """Return the values asked for, by attribute."""
        asked = {attribute: getattr(self, attribute) for attribute in ATTRIBUTES}
        return {attribute: values for attribute, values in asked.items() if values}


class StudyQuery(CitedQuestion):
    """The query of one study."""

    model_config = example()


class Runs(Shape):
    """Scored pipelines of a study; basis and assumed are those of its best-supported pipeline."""

    pipelines: int
    cells: int = Field(description="Number of cells (pipeline, data set, condition) of the study.")
    scored: int = Field(description="Number of cells with a published score.")
    basis: dict[str, Basis] = Field(description="Basis of each part: stated, inferred, ...")
    assumed: dict[str, str] = Field(description="Reason or rule for each part that is not stated.")


class Verification(Shape):
    """A confirmation of a study's values by an author."""

    name: str
    date: str = Field(description="YYYY-MM-DD.")
    confirms: str = Field(description="What the source confirms.")
    source: str


class PublishedScore(Shape):
    """Published numbers of a pipeline on a data set under a condition."""

    own_error_deg: float | None = Field(
        description="Own error; RMS over the units measured elsewhere."
    )
    rms_deg: float | None = Field(description="Unit 0 RMS, over answers to observable samples.")
    bound_deg: float | None = Field(description="RMS Cramer-Rao bound for a known sensor unit.")
    over_bound: float | None = Field(description="Unit 0 RMS of all answers over its bound.")
    availability: float | None


class Headline(PublishedScore):
    """Score with the lowest own error of a study's pipelines."""

    extractor: str
    model: str
    dataset: str
    condition: str


class Departure(Shape):
    """A difference between a study and its implementation here."""

    part: Part = Field(description="Part.")
    value: str
    text: str
    settled_by: str = Field(description="What would remove the difference.")
    unknown: bool = Field(description="A fact is missing.")


class StudyRow(Shape):
    """A study: a row of the table."""

    key: str
    title: str
    authors: str
    year: int | None
    venue: str
    type: str = Field(description="Kind of publication, or unknown.")
    doi: str
    url: str = Field(description="Address; empty if unknown.")
    identity: str = Field(description="Whether a public page confirms author, year and topic.")
    grade: Grade = Field(description="Grade of the implementation.")
    state: State = Field(description="complete: every value is implemented; partial: some; none.")
    values: Annotated[dict[str, list[str]], ColumnEach((*ATTRIBUTES, *REPORTED))] = Field(
        description="Values by attribute of the taxonomy."
    )
    edition: Literal["survey", "extension"] = Field(description="survey or extension.")
    verified: Annotated[list[Verification], AS_TEXT] = Field(description="Checks, with dates.")


class Study(StudyRow):
    """A study. Texts are empty if unknown."""

    sentence: str = Field(description="Implementation and differences.")
    runs: Runs = Field(description="Implementation in the Atlas.")
    headline: Headline | None = Field(description="Lowest own error of its best pipelines.")


class AttributeValue(Shape):
    """A value of a study with its source; empty if unknown."""

    attribute: str
    value: str
    basis: str
    source: str = Field(description="Address, document, study or label of the survey's source.")
    source_name: str = Field(description="Publisher, document or part of the survey.")
    note: str
    role: Literal["proposed", "compared", "unknown", ""] = Field(description="proposed, compared.")
    name_in_study: str = Field(description="Name used in the study, if different.")
    nearest: bool = Field(description="Whether the value is the nearest one in the taxonomy.")


class Setting(Shape):
    """A data set and condition used for a study."""

    dataset: str
    condition: str
    purposes: list[Purpose] = Field(description="Purpose of the study that this shows.")


class SettingScore(Setting, PublishedScore):
    """Published score of a pipeline on a data set and condition; status is null if none."""

    status: str | None


class StudyPipeline(Shape):
    """A pipeline of the study with its data sets and scores."""

    detector: str
    mask: str
    extractor: str
    model: str
    extractor_taxonomy: str
    model_taxonomy: str
    stages: list[str] = Field(description="Survey labels of the compensations, then of the model.")
    basis: dict[str, Basis] = Field(description="Basis of each part: stated, inferred, ...")
    assumed: dict[str, str] = Field(description="Reason or rule for each part that is not stated.")
    datasets: list[str] = Field(description="Data sets on which it can be scored.")
    settings: list[Setting] = Field(description="Data sets and conditions, best first.")
    scores: list[SettingScore] = Field(description="Published score of each setting.")


class Gap(Shape):
    """A value of a study that is not implemented, with the reason."""

    attribute: str
    value: str
    reason: str


class Reported(Shape):
    """A published accuracy or precision with its statistic."""

    value_deg: float = Field(description="The number as published, in degrees.")
    kind: Literal["1sigma", "3sigma", "p95", "rms", "mean", "max", "unspecified"] = Field(
        description="Statistic of the error; unspecified if the source does not say."
    )
    label: str = Field(description="Description of the number.", examples=["1-sigma precision"])
    rms_deg: float = Field(
        description="The number converted to RMS: 3 sigma and maximum divided by 3, 95 % by 1.96, "
        "mean by 0.7979, unspecified as printed."
    )


class Rung(Shape):
    """A method with its own error."""

    extractor: str
    model: str
    own_error_deg: float = Field(description="Own error, or RMS over units: see `nominal`.")
    availability: float | None


class Ladder(Shape):
    """A study's own method, the best method and the bound in one setting."""

    dataset: str
    condition: str
    nominal: bool = Field(description="Whether it is the first condition.")
    own: Rung = Field(description="The study's own method, as in `headline`.")
    best: Rung = Field(description="First pipeline of the leaderboard.")
    bound_deg: float | None = Field(description="Bound with the unit known.")
    bound_unit_deg: float | None = Field(description="Bound with the unit known by references.")


class StudyDetail(Study):
    """A study with the basis of every value and its implementation."""

    note: str
    attributes: list[AttributeValue]
    reported_accuracy: Reported | None = Field(description="As reported for its own sensor.")
    reported_precision: Reported | None = Field(description="Scatter of repeated readings.")
    own_sensor: str = Field(description="Its own data set, or empty.")
    ladder: Ladder | None = Field(description="Rungs below the reported accuracy.")
    departures: list[Departure] = Field(description="Differences from the study.")
    purposes: dict[Purpose, str] = Field(description="What it is run for, with the rules.")
    pipelines: list[StudyPipeline]
    gaps: list[Gap] = Field(description="Attributes without a known value.")


class Edition(Shape):
    """An edition of the studies, for citation."""

    name: Literal["survey", "extension"]
    title: str
    studies: int
    last_year: int = Field(description="Year of its latest study.")
    later: int = Field(description="Studies after the latest one of the survey.")
    version: str = Field(description="Version, studies, digits of the tables' SHA-256.")


class Editions(Shape):
    """Studies of the survey, and studies it does not map."""

    items: list[Edition]


class StudiesQuery(CitedQuestion, StudyFilters, SortedQuestion, rows=StudyRow):
    """Which studies."""

    model_config = example(detector=["CMOS"], mask=["Multi-Ap."], limit=1)

    key: Several[words.StudyKey] = several("Only studies with one of these keys.")
    year_min: Annotated[int | None, WHOLE] = Field(None, ge=0, le=9999, description="First year.")
    year_max: Annotated[int | None, WHOLE] = Field(None, ge=0, le=9999, description="To this year.")
    grade: Several[Grade] = several(
        "Only studies with this grade: faithful (every part is the study's own), assumed (facts "
        "are unknown), close (one part differs), stand-in (more), none."
    )
    state: Several[State] = several("Only studies with this state of implementation.")
    q: Annotated[str | None, GIVEN] = Field(
        None,
        min_length=1,
        max_length=200,
        description="Search words; all must occur in key, title, authors or venue. Case does not "
        "matter.",
    )


Studies = page_of(Study, "Studies", "A page of studies.")
