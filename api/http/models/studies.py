"""Which studies are asked for, and what is said of them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from api import columns
from api.http.models import words
from api.http.models.base import Listing, Shape, TableQuestion
from api.http.models.parameters import (
    DEFAULT_PAGE,
    FIELDS,
    GIVEN,
    SORT,
    WHOLE,
    Cursor,
    Limit,
    Several,
    columns_of,
    several,
    sorting,
)
from registry.sensors import Basis
from registry.taxonomy import ATTRIBUTES

State = Literal["complete", "partial", "none"]


def _filter(attribute: str, more: str = "") -> Any:
    text = f"Only studies with one of these values of {attribute}{more}."
    return several(f"{text} Different attributes must all match.")


class StudyFilters(TableQuestion):
    """Filters by the attributes of studies."""

    task: Several[words.Task] = _filter("task")
    error: Several[words.Error] = _filter("error")
    accuracy: Several[words.Accuracy] = _filter("accuracy")
    detector: Several[words.Detector] = _filter("detector")
    mask: Several[words.Mask] = _filter("mask")
    model: Several[words.Model] = _filter("model", " (a parent such as ECM covers its kinds)")
    extractor: Several[words.Extractor] = _filter("extractor")

    def wanted(self) -> dict[str, list[str]]:
        """Return the values asked for, by attribute."""
        asked = {attribute: getattr(self, attribute) for attribute in ATTRIBUTES}
        return {attribute: values for attribute, values in asked.items() if values}


class StudiesQuery(StudyFilters):
    """Which studies."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"detector": ["CMOS"], "mask": ["Multi-Ap."], "limit": 1}]}
    )

    year_min: Annotated[int | None, WHOLE] = Field(
        None, ge=0, le=9999, description="Only studies of this year or later."
    )
    year_max: Annotated[int | None, WHOLE] = Field(
        None, ge=0, le=9999, description="Only studies of this year or earlier."
    )
    state: Several[State] = several("Only studies of which this much can be run.")
    q: Annotated[str | None, GIVEN] = Field(
        None,
        min_length=1,
        max_length=200,
        description="Only studies whose key, title, authors or venue have all these words, case "
        "aside.",
    )
    sort: Annotated[str | None, sorting(columns.STUDIES), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.STUDIES)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class Runs(Shape):
    """What is scored of a study; basis and assumed are of the pipeline that rests on most."""

    pipelines: int
    cells: int = Field(description="Pairs of a pipeline and a data set that it is planned on.")
    scored: int = Field(description="Those of them that have a published score.")
    basis: dict[str, Basis] = Field(
        description="What detector, mask, extractor and model rest on: stated by the study, "
        "inferred, recalled, or filled in by a rule."
    )
    assumed: dict[str, str] = Field(
        description="Of what is not stated, the reason or the rule why it stands there."
    )


class Score(Shape):
    """What is published of a pipeline under the first condition of a data set; null: nothing."""

    dataset: str
    condition: str | None
    status: str | None
    rms_deg: float | None
    bound_deg: float | None
    availability: float | None


class Study(Shape):
    """A mapped study. A text is empty where nothing is known."""

    key: str
    title: str
    authors: str
    year: int | None
    venue: str
    doi: str
    url: str
    identity: str = Field(description="Whether a public page confirms author, year and topic.")
    state: State = Field(
        description="How much of the study runs: every value of its mapping, or some of them, or "
        "none."
    )
    runs: Runs
    values: dict[str, list[str]]


class AttributeValue(Shape):
    """One value of the mapping and where it comes from; an empty value is an empty cell."""

    attribute: str
    value: str
    basis: str
    source: str
    note: str
    role: Literal["proposed", "compared", "unknown", ""] = Field(
        description="Of a model or an extractor: whether the study proposed it or only compared it."
    )


class StudyPipeline(Shape):
    """A pipeline that runs what the study did, and the data sets that it is scored on."""

    detector: str
    mask: str
    extractor: str
    model: str
    extractor_taxonomy: str
    model_taxonomy: str
    stages: list[str] = Field(
        description="The model's compensations by their taxonomy values, and the model itself last."
    )
    basis: dict[str, Basis] = Field(
        description="What detector, mask, extractor and model rest on: the study states it, it is "
        "inferred, recalled, or stands there by a rule."
    )
    assumed: dict[str, str] = Field(
        description="Of what is not stated, the reason or the rule why it stands there."
    )
    datasets: list[str]
    scores: list[Score]


class Gap(Shape):
    """Something of a study that does not run as the mapping states it, and why."""

    attribute: str
    value: str
    reason: str


class Reported(Shape):
    """An accuracy or a precision as published, with the statistic that it is."""

    value_deg: float = Field(description="The number as published, in degrees.")
    kind: Literal["1sigma", "3sigma", "p95", "rms", "mean", "max", "unspecified"] = Field(
        description="Which statistic of the error it is; unspecified where the source does not say."
    )
    label: str = Field(description="What the number is, in words.", examples=["1-sigma precision"])
    rms_deg: float = Field(
        description="The number as the RMS that it is compared as: 3 sigma and a largest error "
        "over 3, 95 % over 1.96, a mean over 0.7979, unspecified as printed."
    )


class StudyDetail(Study):
    """A mapped study with the basis of every value and what of it can be run."""

    note: str
    attributes: list[AttributeValue]
    reported_accuracy: Reported | None = Field(
        description="How far off the study reports its own sensor to be; `scores` are measured "
        "here, on simulated ones."
    )
    reported_precision: Reported | None = Field(
        description="How far repeated readings of its own sensor scatter, which is no accuracy."
    )
    pipelines: list[StudyPipeline]
    gaps: list[Gap]


class Studies(Listing):
    """A page of studies."""

    items: list[Study]
