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


class Dataset(OpenShape):
    """Card of a standard data set."""

    name: str
    version: int
    detector: str
    mask: str
    observation: str
    conditions: list[str]
    description: str
    follows: list[str]
    units: str
    bounds: dict[str, float] = Field(description="Cramer-Rao bound by condition, rms, degrees.")
    splits: dict[str, dict[str, Any]]
    setups: dict[str, dict[str, Any]] = Field(description="What each condition is.")
    preview: str = Field(description="Where its picture is served.")


class Data(Shape):
    """The published data of a split in a condition; null where none are pinned."""

    condition: str
    split: str
    samples: int
    data_hash: str | None
    bound_deg: float | None = Field(description="Cramer-Rao bound, rms over the test split.")


class DatasetDetail(Dataset):
    """Card of a standard data set, with every parameter that its numbers depend on."""

    geometry: dict[str, Any]
    regime: dict[str, Any]
    seeds: dict[str, Any]
    data: list[Data]


class Datasets(Listing):
    """A page of standard data sets."""

    items: list[Dataset]


class Score(OpenShape):
    """What a pipeline achieves on a data set in a condition. Numbers are null where undefined.

    Errors, the bound and their ratio are over the same samples: observable and answered.
    """

    dataset: str
    dataset_version: int
    condition: str
    unit: int = Field(description="Which unit of the sensor; 0 is the standard one.")
    detector: str
    mask: str
    half_fov_deg: float | None
    extractor: str
    extractor_taxonomy: str
    extractor_version: int
    model: str
    model_taxonomy: str
    model_version: int
    status: Literal["ok", "refused", "failed"]
    reason: str = Field(description="Why there is no score; empty where there is one.")
    n_calibration: int | None
    n_test: int | None
    n_observable: int | None = Field(description="Test samples whose direction is observable.")
    availability: float | None = Field(description="Answered share of the observable samples.")
    false_sun: float | None = Field(
        description="Answered share of the samples that are not observable; null without any."
    )
    rms_deg: float | None
    median_deg: float | None
    p95_deg: float | None
    p997_deg: float | None
    max_deg: float | None
    bias_alpha_deg: float | None
    bias_beta_deg: float | None
    rms_alpha_deg: float | None
    rms_beta_deg: float | None
    repeatability_deg: float | None = Field(
        description="Standard deviation of answers to a pose held still, over both axes."
    )
    bound_deg: float | None = Field(description="Cramer-Rao bound, rms.")
    over_bound: float | None = Field(description="RMS error over the bound.")
    over_bound_se: float | None = Field(description="Standard error of that ratio.")


class Scores(Listing):
    """A page of scores."""

    items: list[Score]


class LeaderboardRow(Score):
    """A score with its place. Members `rms_<inner>_<outer>_deg` are errors by off-axis angle."""

    rank: int | None = Field(
        description="Place in the condition by RMS error, or by that over the field asked for. "
        "Pipelines that answer less than 95 % come behind all others; null without an error."
    )
    tied: bool = Field(description="Whether units built alike disagree, so that others share it.")
    unit_rms_deg: list[float | None] | None = Field(
        description="RMS error on each unit of the sensor, the standard one first; null where one "
        "unit is scored."
    )
    low_deg: float | None = Field(description="Smallest RMS error of a unit.")
    high_deg: float | None = Field(description="Largest RMS error of a unit.")
    latency_us: float | None = Field(
        description="Extraction and prediction of one sample on this machine, microseconds; null "
        "where it is not timed."
    )
    time_ratio: float | None = Field(description="The same over the time of a reference.")


class LeaderboardDataset(OpenShape):
    """The leaderboard of a data set."""

    name: str
    version: int
    detector: str
    mask: str
    conditions: list[str]
    rows: list[LeaderboardRow]


class Leaderboard(OpenShape):
    """The published leaderboard; no schema and no data sets where none is published."""

    model_config = ConfigDict(extra="allow", serialize_by_alias=True)

    schema_version: int | str | None = Field(alias="schema")
    datasets: list[LeaderboardDataset]


class LeaderboardRows(Listing):
    """A page of a data set's leaderboard, best first within a condition."""

    items: list[LeaderboardRow]


class Health(Shape):
    """State of the service."""

    status: Literal["ok"]
    version: str
    studies: int
    datasets: int
    scores: int
