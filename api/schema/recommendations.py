"""Architectures that meet requirements, and their calibrations."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from api.schema.advice import ArchitectureAdvice
from api.schema.base import OpenShape, Shape
from api.schema.flows import LeftOut, Link, Node
from registry.measured_pipelines import FINER, LEAST_ANSWERED


class Nominal(Shape):
    """Score under nominal conditions, over the whole field."""

    condition: str
    rms_deg: float | None
    bound_deg: float | None
    over_bound: float | None
    repeatability_deg: float | None
    availability: float | None = Field(
        description="Availability: share of observable samples with an answer."
    )
    false_sun: float | None = Field(
        description="False detections: share of unobservable samples with an answer."
    )


class Units(Shape):
    """Own errors over the measured sensor units."""

    count: int
    least_deg: float = Field(description="Smallest error of a unit, degrees.")
    largest_deg: float = Field(description="Largest error of a unit, degrees.")
    within_limit: int | None = Field(
        description="Number of ten units that meet the maximum error; null without one."
    )
    of: int = Field(description="Ten; extrapolated if fewer than five units were measured.")


class Finer(Shape):
    """A pipeline with a lower error at lower availability."""

    dataset: str
    extractor: str
    model: str
    error_deg: float = Field(description="Its maximum RMS error over conditions.")
    availability: float = Field(description="Its lowest availability over conditions.")


class Measured(Shape):
    """A pipeline on a data set, with its error over the required field of view and conditions."""

    dataset: str
    extractor: str
    model: str
    error_deg: float | None = Field(
        description=(
            "Error used for ranking: maximum RMS error over the required conditions. With "
            "a maximum error or a bench: the error that the required share of units and "
            "benches meets. Null below the required availability."
        )
    )
    condition: str = Field(description="Condition with the maximum error.")
    conditions: dict[str, float | None] = Field(
        description="RMS errors under the conditions to tolerate."
    )
    field_deg: float | None = Field(description="Full field of view of the error.")
    fov_deg: float | None = Field(description="Full field of view of the data set.")
    availability: float | None = Field(description="Lowest availability over the conditions.")
    latency_us: float | None = Field(
        description="Time per sample on this machine, microseconds; null if not timed."
    )
    nominal_deg: float | None = Field(description="RMS error under nominal conditions.")
    nominal: Nominal = Field(description="Score under nominal conditions.")
    own_deg: float | None = Field(
        description="Own error: calibrated with true directions, over sensor units."
    )
    bench_deg: float = Field(description="Calibration-bench error used.")
    needs: list[str] = Field(description="Inputs that the calibration needs besides the sensor.")
    units: Units | None
    finer: Finer | None = Field(
        description=f"Pipeline with the lowest error at {100 * LEAST_ANSWERED:.0f} % availability "
        f"or more; null unless the error here is more than {FINER:g} times as large."
    )


class Calibration(Shape):
    """A calibration (extractor, compensations, model) in the survey's labels, with evidence."""

    rank: int
    extractor: str
    compensations: list[str]
    model: str
    advised: list[str] = Field(description="Advice of the survey that names it.")
    studies: list[str] = Field(description="Studies that used it; empty if none.")
    with_model: int = Field(
        description="Number of studies that use this model and these compensations."
    )
    support: float = Field(
        description="Geometric mean of the architecture's studies, `with_model` and `studies`."
    )
    measured: Measured | None = Field(
        description="Its most accurate pipeline that meets the requirements."
    )
    other_datasets: list[Measured] = Field(
        description="Its most accurate pipeline on each other data set."
    )
    basis: dict[str, Literal["measured", "stated", "studies", "advised", "assessed"]] = Field(
        description="Evidence by which each requirement was checked."
    )


class RecommendationRow(Shape):
    """A calibration of a recommended architecture: a row of the table."""

    rank: int = Field(description="Rank of the architecture.")
    detector: str
    mask: str
    advised: bool = Field(description="Whether the survey advises it for these requirements.")
    studies: list[str] = Field(description="Studies with this architecture.")
    pareto: bool = Field(description="Pareto: no other has both more studies and a lower error.")
    calibration: int = Field(description="Rank of the calibration on the architecture.")
    extractor: str
    compensations: list[str]
    model: str
    calibration_studies: list[str] = Field(description="Studies that used the calibration.")
    support: float = Field(
        description="Geometric mean of the numbers of studies of architecture and calibration."
    )
    measured: Measured | None


class Task(Shape):
    """A task of an architecture."""

    task: str
    studies: int
    advised: bool = Field(description="Whether the survey advises it.")


class TaskMeasure(Shape):
    """Measure by which an architecture is ranked for a task."""

    task: str
    value: float | None
    unit: str
    basis: Literal["measured", "published"]
    built: int = Field(description="Number of built sensors in the median.")
    words: str


class Architecture(Shape):
    """An architecture with evidence and calibrations, best first."""

    rank: int
    detector: str
    mask: str
    tasks: list[Task] = Field(
        description="Tasks of the architecture's studies, or that it is advised for."
    )
    advised: bool = Field(description="Whether the survey advises it for these requirements.")
    advice: list[ArchitectureAdvice] = Field(
        description="Advice of the survey for these requirements."
    )
    studies: list[str]
    best: Calibration = Field(description="The calibration with the lowest measured error.")
    pareto: bool = Field(description="Pareto: no other has both more studies and a lower error.")
    contradiction: str | None = Field(
        description="Sentence, if the most accurate calibration is not the one most studies used."
    )
    measures: list[TaskMeasure] = Field(description="Measures of the requested tasks.")
    count: int = Field(description="Calibrations that meet the requirements.")
    calibrations: list[Calibration] = Field(
        description="Calibrations of the architecture, best first."
    )


class Regret(Shape):
    """Accuracy lost by the ranking: first calibration compared with the most accurate one."""

    first_deg: float | None = Field(
        description="Error of the first calibration, degrees; null if not measured."
    )
    best_deg: float = Field(
        description="Lowest measured error that meets the requirements, degrees."
    )
    ratio: float | None = Field(
        description="Error of the first calibration over the lowest; null if unknown or over zero."
    )
    sentence: str = Field(description="The comparison as a sentence.")


class Pair(Shape):
    """An architecture: detector and mask."""

    detector: str
    mask: str


class Path(Shape):
    """A combination of values used in studies."""

    task: str
    detector: str
    mask: str
    model: str
    extractor: str
    studies: list[str]


class Relaxation(OpenShape):
    """A change of the requirements that gives results."""

    constraint: str
    architectures: int
    words: str


class Blocked(Shape):
    """Why no architecture meets the requirements."""

    constraint: str
    detail: str
    relaxations: list[Relaxation] = Field(
        description="Changes of the requirements that give results."
    )


class Recommendations(Shape):
    """Architectures for a set of requirements, their calibrations, and the studies behind them."""

    requirements: dict[str, Any] = Field(description="Requirements as interpreted.")
    sort: str = Field(description="Order of the list.")
    count: int = Field(description="Number of architectures that meet the requirements.")
    designs: int = Field(description="Number of their calibrations.")
    architectures: list[Architecture]
    contradictions: list[str] = Field(
        description="Sentences, where an architecture that is not advised has better results."
    )
    regret: Regret | None = Field(
        description=(
            "Comparison of the first calibration with the most accurate one; null if none "
            "is measured."
        )
    )
    untimed: int = Field(
        description=(
            "Number of pipelines excluded by the latency limit because they were not timed."
        )
    )
    untried: dict[str, list[Pair]] = Field(
        description="Architectures without a data set that tests the required condition."
    )
    paths: list[Path] = Field(
        description="Combinations of values from task to extractor, with their studies."
    )
    nodes: list[Node]
    links: list[Link]
    left_out: list[LeftOut] = Field(
        description="Studies not shown because an attribute is unknown."
    )
    blocked: Blocked | None = Field(
        description="Why no architecture meets the requirements; null otherwise."
    )
