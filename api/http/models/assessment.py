"""Sweeps on reference features, and the survey's assessment beside the measured one."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from api import columns
from api.http.models.base import Listing, OpenShape, Shape, TableQuestion
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
from api.http.models.words import ExtractorName, MethodName, Series, SweepName

Agreement = Literal["agrees", "near", "opposed", "not judged", "not measured"]


class SweepsQuery(TableQuestion):
    """Which sweeps."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"series": ["disc"], "sweep": ["noise"], "extractor": ["bctm"], "limit": 1}
            ]
        }
    )

    series: Several[Series] = several("Only this feature.")
    sweep: Several[SweepName] = several("Only this sweep.")
    extractor: Several[ExtractorName] = several("Only this extractor.")
    sort: Annotated[str | None, sorting(columns.SWEEPS), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.SWEEPS)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class AssessmentQuery(TableQuestion):
    """Which methods."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"method": ["BCTM"]}]})

    method: Several[MethodName] = several("Only this method of the survey's table.")


class Sweep(OpenShape):
    """Error of an extractor at a point of a sweep. Numbers are null if undefined."""

    series: str = Field(description="Name of the reference feature.")
    sweep: str = Field(description="Varied quantity; empty if not measured.")
    point: str
    value: float | None = Field(
        description="Position on the axis of the sweep; null if it is a word."
    )
    extractor: str
    extractor_taxonomy: str
    extractor_version: int
    status: Literal["ok", "refused", "failed"]
    reason: str
    n: int = Field(description="Samples.")
    unit: str
    found_fraction: float | None
    kept_fraction: float | None = Field(
        description="Share of samples found within 3 px of the truth."
    )
    wrong_fraction: float | None = Field(
        description=(
            "Share of samples answered more than 1 px from the truth, or without a feature."
        )
    )
    rms: float | None = Field(description="Root mean square error of one coordinate.")
    bias: float | None = Field(description="RMS over the coordinates of the mean error.")
    bound: float | None = Field(description="Cramer-Rao bound of one coordinate.")
    over_bound: float | None = Field(description="RMS error divided by the bound.")


class Sweeps(Listing):
    """A page of sweeps."""

    items: list[Sweep]


class Verdict(Shape):
    """A property of a method; scores are 2, 1 or 0."""

    property: str
    survey: int
    measured: int | None = Field(description="Measured score; null if not judged or not measured.")
    agreement: Agreement = Field(
        description=(
            "agrees, near (one apart), opposed (two apart), not measured, or not judged: "
            "the measurement cannot contradict the survey."
        )
    )
    value: float | None = Field(description="The measured quantity.")
    unit: str
    extractor: str
    measured_on: str
    reason: str = Field(description="Reason if not judged, not measured or not found.")


class Method(Shape):
    """One method of the survey's table."""

    method: str
    taxonomy: str
    case_study: str
    extractors: list[str]
    counts: dict[str, int]
    properties: list[Verdict]


class PropertyDefinition(Shape):
    """How a property is measured."""

    property: str
    source: str
    measure: str
    limits: str
    judged: Literal["always", "claimed", "failed", "never"] = Field(
        description=(
            "When the measurement can contradict the survey: score 1 or 2 (claimed), or "
            "measured below 2 (failed)."
        )
    )
    why: str = Field(description="Why it cannot contradict in other cases.")


class Assessment(Shape):
    """The survey's assessment beside the measured one."""

    definitions: list[PropertyDefinition]
    methods: list[Method]
    totals: dict[str, int] = Field(description="Number of verdicts by agreement.")
