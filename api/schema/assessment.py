"""Sweeps on reference features, and the survey's assessment beside the measured one."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from api.schema.base import OpenShape, Shape, SortedQuestion, TableQuestion, example, page_of
from api.schema.parameters import Several, several
from api.schema.words import ExtractorName, MethodName, Series, SweepName

Agreement = Literal["agrees", "near", "opposed", "not judged", "not measured"]


class AssessmentQuery(TableQuestion):
    """Which methods."""

    model_config = example(method=["BCTM"])

    method: Several[MethodName] = several("Only this method of the survey's table.")


class Sweep(OpenShape):
    """Error of an extractor at a point of a sweep. Numbers are null if undefined."""

    series: str = Field(description="Name of the reference feature.")
    sweep: str = Field(description="Varied quantity; empty if not measured.")
    point: str = Field(description="Point of the sweep; none if not measured.")
    extractor: str
    rms: float | None = Field(description="Root mean square error of one coordinate.")
    bound: float | None = Field(description="Cramer-Rao bound of one coordinate.")
    over_bound: float | None = Field(description="Unit 0 RMS divided by the bound.")
    status: Literal["ok", "refused", "failed"]
    value: float | None = Field(description="Position on the axis; null if it is a word.")
    n: int = Field(description="Samples.")
    unit: str
    found_fraction: float | None = Field(description="Share of samples with a feature found.")
    kept_fraction: float | None = Field(description="Share found within 3 px of the truth.")
    wrong_fraction: float | None = Field(description="Share more than 1 px off, or not found.")
    bias: float | None = Field(description="RMS over the coordinates of the mean error.")
    reason: str
    extractor_taxonomy: str
    extractor_version: int


class JudgedProperty(Shape):
    """A property of a method as the survey and the measurement score it: 2, 1 or 0."""

    property: str
    survey: int
    measured: int | None = Field(description="Measured score; null if not judged or not measured.")
    agreement: Agreement = Field(
        description="agrees, near (one apart), opposed (two apart), not measured, or not judged: "
        "the measurement cannot contradict the survey."
    )
    value: float | None = Field(description="The measured quantity.")
    reason: str = Field(description="Reason if not judged, not measured or not found.")


class Measurement(Shape):
    """What a score rests on."""

    unit: str = Field(description="Unit of the value.")
    extractor: str
    measured_on: str = Field(description="Data that the value is measured on.")


class NamedMethod(Shape):
    """A method of the survey's table."""

    method: str


class MethodGroup(Shape):
    """Where a method stands."""

    taxonomy: str
    case_study: str = Field(description="Case study of the survey that the method belongs to.")


# Members of a class stand behind those of the classes named after it.
class Verdict(Measurement, JudgedProperty):
    """A property of a method; scores are 2, 1 or 0."""


class VerdictRow(Measurement, MethodGroup, JudgedProperty, NamedMethod):
    """A property of a method: a row of the table."""


class Method(MethodGroup, NamedMethod):
    """One method of the survey's table."""

    extractors: list[str] = Field(description="Extractors that implement the method.")
    counts: dict[str, int] = Field(description="Number of properties by outcome.")
    properties: list[Verdict]


class PropertyDefinition(Shape):
    """How a property is measured."""

    property: str
    source: str
    measure: str = Field(description="Quantity that decides the property.")
    limits: str = Field(description="Thresholds between the scores.")
    judged: Literal["always", "claimed", "failed", "never"] = Field(
        description="When it can contradict the survey."
    )
    why: str = Field(description="Why it cannot contradict in other cases.")


class Assessment(Shape):
    """The survey's assessment beside the measured one."""

    definitions: list[PropertyDefinition] = Field(description="How each property is measured.")
    methods: list[Method] = Field(description="Methods that the survey assesses.")
    totals: dict[str, int] = Field(description="Number of verdicts by agreement.")


class SweepsQuery(SortedQuestion, rows=Sweep):
    """Which sweeps."""

    model_config = example(series=["disc"], sweep=["noise"], extractor=["bctm"], limit=1)

    series: Several[Series] = several("Only this feature.")
    sweep: Several[SweepName] = several("Only this sweep.")
    extractor: Several[ExtractorName] = several("Only this extractor.")


Sweeps = page_of(Sweep, "Sweeps", "A page of sweeps.")
