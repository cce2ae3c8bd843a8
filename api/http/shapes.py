"""Shapes of the answers, for the OpenAPI document; tests hold live answers against them."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field


class Shape(BaseModel):
    """An answer or a part of one: exactly these members."""

    model_config = ConfigDict(extra="forbid")


class OpenShape(BaseModel):
    """An answer or a part of one whose producer may say more than these members."""

    model_config = ConfigDict(extra="allow")


class Violation(Shape):
    """One thing wrong with a request."""

    parameter: str
    value: str | None
    expected: str
    nearest: str | None = Field(description="The nearest valid name or value.")


class ProblemDocument(Shape):
    """A refusal (RFC 9457)."""

    type: str
    title: str
    status: int
    detail: str
    instance: str
    errors: list[Violation]


class TaxonomyValue(Shape):
    """A word of the vocabulary."""

    value: str
    name: str
    category: str
    section: str = Field(description="Label in the survey; empty where it has none.")


class Taxonomy(Shape):
    """The vocabulary of the survey's mapping, by attribute."""

    attributes: dict[str, list[TaxonomyValue]]


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
    state: Literal["complete", "partial", "none"] = Field(
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


class Listing(Shape):
    """A page of a list."""

    total: int = Field(description="Items of the whole list.")
    next: str | None = Field(description="Cursor of the next page; null on the last.")


class Studies(Listing):
    """A page of studies."""

    items: list[Study]


class Node(Shape):
    """A value at a level of a decision flow."""

    id: str
    level: str
    value: str
    name: str
    count: float = Field(description="Distinct studies, or the sum of their fractions.")
    studies: list[str]


class Link(Shape):
    """Studies that go from one value to another."""

    source: str
    target: str
    value: float = Field(description="Distinct studies, or the sum of their fractions.")
    studies: list[str]


class LeftOut(Shape):
    """Studies without a value at a level."""

    level: str
    count: int
    studies: list[str]


class Flows(Shape):
    """A decision flow: a Sankey diagram, or the rings of a sunburst."""

    chart: str
    levels: list[str]
    counting: Literal["studies", "fractional"]
    studies: int = Field(description="Studies that met the filters.")
    nodes: list[Node]
    links: list[Link]
    left_out: list[LeftOut]


class Measured(Shape):
    """The best measured pipeline of a path, in the condition asked for."""

    dataset: str
    condition: str
    extractor: str
    model: str
    rms_deg: float | None
    bound_deg: float | None
    over_bound: float | None
    half_fov_deg: float | None
    latency_us: float | None = Field(
        description="Of one sample on this machine, microseconds; null where it is not timed."
    )
    availability: float | None = Field(
        description="Answered share of the samples whose direction is observable."
    )
    false_sun: float | None = Field(description="Answered share of the other samples.")


class Literature(Shape):
    """How the literature backs a path: numbers of distinct studies that meet the requirements."""

    studies: int = Field(description="Of the whole path.")
    with_model: int = Field(description="Of task, detector, mask and model.")
    architecture: int = Field(description="Of task, detector and mask.")
    support: float = Field(description="Geometric mean of the three.")


class Path(Shape):
    """A way from a task to a calibrated sensor."""

    rank: int
    task: str
    detector: str
    mask: str
    model: str
    extractor: str
    studies: list[str]
    literature: Literature
    measured: Measured | None
    basis: dict[str, Literal["measured", "stated"]] = Field(
        description="On what each numeric requirement was judged."
    )
    pareto: bool = Field(description="Whether no path is better in literature and measurement.")


class Relaxation(OpenShape):
    """A change of the requirements that leaves paths."""

    constraint: str
    paths: int


class Blocked(Shape):
    """Why nothing is left."""

    constraint: str
    detail: str
    relaxations: list[Relaxation]


class Recommendations(Shape):
    """Ranked paths for a set of requirements, and the flow of the studies behind them."""

    requirements: dict[str, Any]
    count: int = Field(description="Paths that meet the requirements, beyond `limit` too.")
    paths: list[Path]
    nodes: list[Node]
    links: list[Link]
    left_out: list[LeftOut] = Field(description="Studies on no path for want of a value.")
    blocked: Blocked | None


class Algorithm(Shape):
    """An implementation."""

    name: str
    role: Literal["extractor", "model"]
    taxonomy: str
    category: str | None
    observation: str | None = Field(description="What an extractor reads.")
    kind: str | None = Field(description="What an extractor's features mean.")
    accepts: list[str] | None = Field(description="Kinds of features a model reads.")
    labels: list[str]
    studies: list[str]
    origin: str
    version: int
    summary: str


class Algorithms(Listing):
    """A page of implementations."""

    items: list[Algorithm]


class Health(Shape):
    """State of the service."""

    status: Literal["ok"]
    version: str
    studies: int
    datasets: int
    scores: int
