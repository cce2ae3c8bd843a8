"""Which studies are asked for, and what is said of them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from api import columns
from api.http.models import words
from api.http.models.base import CitedQuestion, Listing, Question, Shape, TableQuestion
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
from registry.fidelity.particulars import Purpose
from registry.sensors import Basis
from registry.taxonomy import ATTRIBUTES
from survey_data.editions import Choice

State = Literal["complete", "partial", "none"]
Grade = Literal["faithful", "close", "stand-in", "none"]


def _filter(attribute: str, more: str = "") -> Any:
    text = f"Only studies with one of these values of {attribute}{more}."
    return several(f"{text} Different attributes must all match.")


class OfEdition(Question):
    """Of which edition of the studies."""

    edition: Choice = Field(
        "survey",
        description="The survey's studies, or all: these and the ones added after it.",
    )


class StudyFilters(OfEdition, TableQuestion):
    """Filters by edition and by the attributes of studies."""

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


class StudiesQuery(CitedQuestion, StudyFilters):
    """Which studies."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"detector": ["CMOS"], "mask": ["Multi-Ap."], "limit": 1}]}
    )

    key: Several[words.StudyKey] = several("Only studies with one of these keys.")
    year_min: Annotated[int | None, WHOLE] = Field(
        None, ge=0, le=9999, description="Only studies of this year or later."
    )
    year_max: Annotated[int | None, WHOLE] = Field(
        None, ge=0, le=9999, description="Only studies of this year or earlier."
    )
    grade: Several[Grade] = several(
        "Only studies whose run is so near to them: faithful (every part is its own, stated or "
        "inferred with a reason), close (one part departs from it), stand-in (more do), none "
        "(nothing of it runs)."
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


class StudyQuery(CitedQuestion):
    """The query of one study."""

    model_config = ConfigDict(json_schema_extra={"examples": [{}]})


class Runs(Shape):
    """What is scored of a study; basis and assumed are of the pipeline that rests on most."""

    pipelines: int
    cells: int = Field(
        description="Pairs of a pipeline and a data set under a condition that stand for the study."
    )
    scored: int = Field(description="Those of them that have a published score.")
    basis: dict[str, Basis] = Field(
        description="What detector, mask, extractor and model rest on: stated by the study, "
        "inferred, implied by the survey's definition of its methods, recalled, or chosen by a "
        "rule."
    )
    assumed: dict[str, str] = Field(
        description="Of what is not stated, the reason or the rule why it stands there."
    )


class Score(Shape):
    """What is published of a pipeline on a data set under a condition; a null status: nothing."""

    dataset: str
    condition: str
    purposes: list[Purpose] = Field(
        description="What the study is run for that this shows: albedo, temperature, flight."
    )
    status: str | None
    rms_deg: float | None
    bound_deg: float | None
    availability: float | None


class Verification(Shape):
    """A confirmation of what is said of a study, by one of its authors or of the survey's."""

    name: str
    date: str = Field(description="YYYY-MM-DD.")
    confirms: str
    source: str


class Headline(Shape):
    """The score that a study is shown by."""

    extractor: str
    model: str
    dataset: str
    condition: str
    rms_deg: float
    bound_deg: float | None
    availability: float | None


class Departure(Shape):
    """A part of a study's run that is not the study's own."""

    part: Literal["sensor", "condition", "extractor", "model", "compensation"]
    value: str
    text: str
    settled_by: str = Field(description="What would make the part the study's own.")


class Study(Shape):
    """A mapped study. A text is empty where nothing is known."""

    key: str
    title: str
    authors: str
    year: int | None
    venue: str
    type: str = Field(
        description="Kind of publication: journal, conference, preprint, thesis, ... or unknown."
    )
    doi: str
    url: str
    identity: str = Field(description="Whether a public page confirms author, year and topic.")
    edition: Literal["survey", "extension"] = Field(
        description="Whether it is among the survey's studies or was added after it."
    )
    verified: list[Verification]
    grade: Grade = Field(description="How near what runs is to the study.")
    sentence: str = Field(description="What runs, and what of it is missing or chosen.")
    state: State = Field(
        description="Whether gaps are left: every value of its mapping runs, or some of them, or "
        "none. The grade says how near that is to the study."
    )
    runs: Runs
    headline: Headline | None = Field(
        description="Least error of the pipelines that rest on most, each where it tells most of "
        "the study; null where that is not measured."
    )
    values: dict[str, list[str]]


class AttributeValue(Shape):
    """One value of the mapping and where it comes from; an empty value is an empty cell."""

    attribute: str
    value: str
    basis: str
    source: str = Field(description="Address, document, study or label of the survey's source.")
    source_name: str = Field(description="Publisher, document or part of the survey.")
    note: str
    role: Literal["proposed", "compared", "unknown", ""] = Field(
        description="Of a model or an extractor: whether the study proposed it or only compared it."
    )
    name_in_study: str = Field(
        description="What the study calls it, where that is known and not the taxonomy's name."
    )
    nearest: bool = Field(
        description="The taxonomy has no such value; this is the nearest that it has."
    )


class Setting(Shape):
    """A data set under a condition that stands for a study."""

    dataset: str
    condition: str
    purposes: list[Purpose] = Field(description="What the study is run for that it shows.")


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
    datasets: list[str] = Field(description="All data sets that it can be scored on.")
    settings: list[Setting] = Field(
        description="Those of them that stand for the study, the one that tells most first."
    )
    scores: list[Score] = Field(description="What is published of each of the settings.")


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
    departures: list[Departure] = Field(description="What keeps the run from being faithful.")
    purposes: dict[Purpose, str] = Field(
        description="What the study is run for, with the rule that says so."
    )
    pipelines: list[StudyPipeline]
    gaps: list[Gap]


class Edition(Shape):
    """An edition of the studies, as it is cited."""

    name: Literal["survey", "extension"]
    title: str
    studies: int
    version: str = Field(
        description="Version of the data package, number of studies, first digits of the SHA-256 "
        "of the edition's tables."
    )


class Editions(Shape):
    """The survey's studies, and those after it."""

    items: list[Edition]


class Studies(Listing):
    """A page of studies."""

    items: list[Study]
