"""Which studies are asked for, and what is said of them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from api.http.models import words
from api.http.models.base import Listing, Question, Shape
from api.http.models.parameters import DEFAULT_PAGE, GIVEN, WHOLE, Cursor, Limit, Several, several
from registry.taxonomy import ATTRIBUTES

State = Literal["complete", "partial", "none"]


def _filter(attribute: str, more: str = "") -> Any:
    text = f"Only studies with one of these values of {attribute}{more}."
    return several(f"{text} Different attributes must all match.")


class StudyFilters(Question):
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
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


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
        description="How much of the study can be run: every value of its mapping, some, none."
    )
    values: dict[str, list[str]]


class AttributeValue(Shape):
    """One value of the mapping and where it comes from; an empty value is an empty cell."""

    attribute: str
    value: str
    basis: str
    source: str
    note: str


class StudyPipeline(Shape):
    """A pipeline that runs what the study did, and the data sets it can be scored on."""

    detector: str
    mask: str
    extractor: str
    model: str
    extractor_taxonomy: str
    model_taxonomy: str
    assumed: dict[str, str] = Field(
        description="What the study states where that is not what runs: None, or a parent."
    )
    datasets: list[str]


class Gap(Shape):
    """Something of a study that cannot be run."""

    attribute: str
    value: str
    reason: str


class StudyDetail(Study):
    """A mapped study with the basis of every value and what of it can be run."""

    note: str
    attributes: list[AttributeValue]
    pipelines: list[StudyPipeline]
    gaps: list[Gap]


class Studies(Listing):
    """A page of studies."""

    items: list[Study]
