"""Architectures that meet requirements, their evidence and their calibrations."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from api.schema.base import Shape
from api.schema.boards import HeightOrder
from api.schema.flows import LeftOut, Link, Node

State = Literal["meets", "misses", "unknown"]


class Reported(Shape):
    """What a study or a built sensor reports."""

    key: str = Field(description="Key of the study, or id of the built sensor.")
    kind: Literal["study", "product"]
    name: str = Field(description="Title of the study, or name of the sensor; may be empty.")
    year: int | None
    doi: str
    accuracy_deg: float | None = Field(description="Accuracy as published, degrees.")
    accuracy_kind: str | None = Field(description="What that number is, in words.")
    rms_deg: float | None = Field(description="The accuracy as an RMS, degrees.")
    classes: list[str] = Field(description="Accuracy classes.")
    fov_deg: float | None = Field(description="Full field of view, degrees.")
    mass_g: float | None = Field(description="Mass, grams.")
    power_mw: float | None = Field(description="Power from the spacecraft, milliwatts.")
    supply: str = Field(description="self-powered, passive, or empty.")
    rate_hz: float | None = Field(description="Update rate, hertz.")


class Measured(Shape):
    """A pipeline on a data set, over the required field of view and conditions."""

    dataset: str
    extractor: str
    model: str
    condition: str = Field(description="Condition with the largest error.")
    field_deg: float | None = Field(description="Full field of view of the error.")
    flight_error_deg: float | None = Field(
        description="Error in flight: geometric mean over sensor units; null if not flown."
    )
    flight_low_deg: float | None = Field(description="Error in flight less two standard errors.")
    flight_high_deg: float | None = Field(description="Error in flight plus two standard errors.")
    own_error_deg: float | None = Field(description="Own error: geometric mean over sensor units.")
    own_low_deg: float | None = Field(description="Own error less two standard errors.")
    own_high_deg: float | None = Field(description="Own error plus two standard errors.")
    on_bench_deg: float | None = Field(description="Error on your bench, at the confidence.")
    needs_bench_deg: float | None = Field(description="Bench that the limit takes; 0 if none.")
    units_within: int | None = Field(description="Of ten units, how many meet the maximum error.")
    bound_deg: float | None = Field(description="Cramer-Rao bound for a known unit.")
    availability: float | None
    latency_us: float | None = Field(description="Time per sample on your processor.")
    needs: list[str] = Field(description="Inputs that the calibration needs besides the sensor.")


class Calibration(Shape):
    """A calibration (extractor, compensations, model) in the survey's labels, with evidence."""

    name: str = Field(description="Measured pipeline, or the survey's labels.")
    extractor: str
    compensations: list[str]
    model: str
    advised: bool = Field(description="Whether the survey advises it by name.")
    studies: list[str] = Field(description="Studies that used it.")
    with_model: int = Field(description="Number of studies that use its stages.")
    measured: Measured | None


class EvidenceState(Shape):
    """What the kinds of evidence say of a requirement; null where a kind cannot judge it."""

    requirement: str = Field(description="Requirement.")
    reported: State | None = Field(description="By reports.")
    measured: State | None = Field(description="By measurements.")
    advised: State | None = Field(description="By the survey's advice.")


class Advised(Shape):
    """What the survey advises an architecture for."""

    value: str = Field(description="Task, accuracy class or error.")
    how: str = Field(description="Calibrations that the advice names; empty if open.")
    section_name: str = Field(description="Name of the section, with printed number.")


class TaskMeasure(Shape):
    """Own measure of a task."""

    task: str
    value: float | None
    unit: str
    products: int = Field(description="Number of distinct products in the median.")
    low: float | None = Field(description="Smallest value of a product.")
    high: float | None = Field(description="Largest value of a product.")
    words: str


class Architecture(Shape):
    """An architecture with its evidence and its best calibration."""

    rank: int | None = Field(description="Rank; equal errors share one. Null if nothing is asked.")
    tied: bool = Field(description="Whether the rank is shared.")
    detector: str
    mask: str
    built: bool = Field(description="Whether a study or product realises it.")
    meets: list[Literal["reported", "measured"]] = Field(description="Evidence that meets all.")
    reason: str = Field(description="Why it is in the answer, one sentence.")
    evidence: list[EvidenceState] = Field(description="Evidence for each requirement.")
    studies: int = Field(description="Number of its studies.")
    products: int = Field(description="Number of distinct built sensors.")
    reports: list[Reported] = Field(description="Best reports that meet all, or the nearest.")
    advised: list[Advised] = Field(description="Advice of the survey for these requirements.")
    best: Calibration | None = Field(description="Best calibration, or the nearest.")
    measures: list[TaskMeasure] = Field(description="Measures of the requested tasks.")
    count: int = Field(description="Number of its calibrations that meet the requirements.")
    calibrations: list[Calibration] | None = Field(None, description="If included.")
    links: dict[str, str] = Field(description="Its page, studies and leaderboard.")


class Card(Shape):
    """One way to begin, where nothing is asked."""

    title: Literal["most built", "advised for accuracy", "lowest simulated"]
    detector: str
    mask: str
    built: bool = Field(description="Whether a study or product realises it.")
    words: str


class Contradiction(Shape):
    """Two calibrations of an architecture on the same data set and condition."""

    detector: str
    mask: str
    kind: Literal["studies", "advice"]
    dataset: str
    condition: str
    first: str = Field(description="Calibration that most studies used, or that is advised.")
    first_own_error_deg: float = Field(description="Its own error, degrees.")
    other: str = Field(description="Calibration with the smallest own error there.")
    other_own_error_deg: float = Field(description="Its own error, degrees.")
    studies: int = Field(description="Number of studies that used the first.")
    ratio: float | None = Field(description="First error over the other.")
    sentence: str = Field(description="The comparison in words.")


class Relaxation(Shape):
    """A change of the requirements that gives results."""

    drop: dict[str, Any] = Field(description="Requirements to leave out.")
    change: dict[str, Any] = Field(description="Requirements with their new values.")
    architectures: int
    words: str


class Blocked(Shape):
    """Why no architecture meets the requirements."""

    constraint: str
    detail: str
    relaxations: list[Relaxation] = Field(description="Changes that give results.")


class RecommendationRow(Shape):
    """A calibration of a recommended architecture: a row of the table.

    An architecture that reports alone bring into the answer has one row without a calibration.
    """

    rank: int | None = Field(description="Rank of the architecture; empty if nothing is asked.")
    detector: str
    mask: str
    built: bool = Field(description="Whether a study or product realises it.")
    meets: list[str] = Field(description="Kinds of evidence that meet all requirements.")
    reported_by: list[str] = Field(description="Studies and products that report meeting all.")
    reported_rms_deg: float | None = Field(description="Smallest reported accuracy, as an RMS.")
    calibration: int | None = Field(description="Rank of the calibration on the architecture.")
    name: str | None = Field(description="Measured pipeline, or the survey's labels.")
    extractor: str | None
    compensations: list[str]
    model: str | None
    advised: bool | None = Field(description="Whether the survey advises it by name.")
    calibration_studies: list[str] = Field(description="Studies that used the calibration.")
    measured: Measured | None


class Designs(Shape):
    """A page of all calibrations of an answer, as flat rows."""

    items: list[RecommendationRow]
    total: int = Field(description="Total number of rows.")
    next: str | None = Field(description="Address of the next page; null on the last one.")


class Path(Shape):
    """A combination of values used in studies."""

    task: str
    detector: str
    mask: str
    model: str
    extractor: str
    studies: list[str]


class AnswerFlow(Shape):
    """The decision flow of an answer, from task to feature extractor."""

    levels: list[str] = Field(description="Attributes from left to right.")
    paths: list[Path] = Field(description="Combinations of values with their studies.")
    nodes: list[Node]
    links: list[Link]
    left_out: list[LeftOut] = Field(description="Studies with an unknown attribute.")


class Recommendations(Shape):
    """Architectures for a set of requirements, with the evidence behind each."""

    requirements: dict[str, Any] = Field(description="Requirements as interpreted.")
    level: Literal["flight", "own"] = Field(description="Level of error that limits are judged by.")
    sort: str = Field(description="Order of the list.")
    order: str = Field(description="The order in one sentence.")
    count: int = Field(description="Number of architectures that meet the requirements.")
    designs: int = Field(description="Number of their calibrations.")
    notes: list[str] = Field(description="How it was read; ties; benches in the way.")
    height_order: HeightOrder | None = Field(
        description="How far errors follow 1/height; null if nothing is asked, or of too few."
    )
    cards: list[Card] = Field(description="Three ways to begin; empty if anything is asked.")
    architectures: list[Architecture]
    next: str | None = Field(description="Cursor of the next page; null on the last page.")
    contradictions: list[Contradiction] = Field(description="On the same data; at most two.")
    blocked: Blocked | None = Field(description="Why the answer is empty; else null.")
    paths: list[Path] | None = Field(None, description="With include=paths.")
    rows: Designs | None = Field(None, description="All calibrations; with include=designs.")
    links: dict[str, str] = Field(description="The same as a table, and its decision flow.")
