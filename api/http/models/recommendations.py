"""Requirements, and the architectures that meet them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from api.http.models import words
from api.http.models.base import OpenShape, Shape, TableQuestion
from api.http.models.flows import LeftOut, Link, Node
from api.http.models.parameters import LARGEST_PAGE, NUMBER, WHOLE, Several, several
from api.http.models.studies import OfEdition
from registry.measured_pipelines import FINER, LEAST_ANSWERED
from registry.ranking import Sort


def _wanted(attribute: str) -> Any:
    return several(f"Require one of these values of {attribute}.")


def _unwanted(attribute: str) -> Any:
    return several(f"Exclude these values of {attribute}.")


Number = Annotated[float | None, NUMBER]


class Requirements(OfEdition):
    """Requirements on a sensor and its calibration."""

    task: Several[words.Task] = _wanted("task")
    error: Several[words.Error] = _wanted("error")
    accuracy: Several[words.Accuracy] = _wanted("accuracy")
    detector: Several[words.Detector] = _wanted("detector")
    mask: Several[words.Mask] = _wanted("mask")
    model: Several[words.Model] = _wanted("model")
    extractor: Several[words.Extractor] = _wanted("extractor")
    exclude_task: Several[words.Task] = _unwanted("task")
    exclude_error: Several[words.Error] = _unwanted("error")
    exclude_accuracy: Several[words.Accuracy] = _unwanted("accuracy")
    exclude_detector: Several[words.Detector] = _unwanted("detector")
    exclude_mask: Several[words.Mask] = _unwanted("mask")
    exclude_model: Several[words.Model] = _unwanted("model")
    exclude_extractor: Several[words.Extractor] = _unwanted("extractor")
    # No more than directions, a full turn, and 11 days.
    max_error_deg: Number = Field(
        None,
        gt=0,
        le=180,
        description=(
            "Maximum RMS error, degrees, over the required field of view and conditions. "
            "Measured; if not measured, the stated accuracy converted to RMS."
        ),
    )
    min_fov_deg: Number = Field(
        None,
        gt=0,
        le=360,
        description="Minimum full field of view, degrees. Measured; if not measured, stated.",
    )
    max_latency_us: Number = Field(
        None,
        gt=0,
        le=1e12,
        description="Maximum time of extraction and prediction per sample, microseconds.",
    )
    min_availability: Number = Field(
        None,
        gt=0,
        le=1,
        description="Minimum availability, nominal and under all required conditions.",
    )
    survive: Several[words.Hazard] = several(
        "Conditions to tolerate: a data set must test each, with sufficient "
        "availability and within the maximum error."
    )
    properties: Several[words.Property] = several(
        "Required extractor properties, at least partly provided in the survey's assessment."
    )
    exclude_needs: Several[words.Need] = several(
        "Exclude calibrations that need one of these inputs."
    )
    bench_deg: Number = Field(
        None,
        ge=0,
        le=180,
        description=(
            "Calibration-bench error, degrees; by default that of each data set's "
            "standard bench; 0 for own errors."
        ),
    )
    confidence: Number = Field(
        None,
        ge=0.5,
        le=0.999,
        description=(
            "Share of sensor units and benches that must meet the maximum error; default 0.9."
        ),
    )
    sort: Sort = Field(
        "advice",
        description=(
            "Ranking. advice: advised or used in studies first, then by the measure of "
            "the tasks or by error. support: by number of studies. measured: by error."
        ),
    )
    limit: Annotated[int, WHOLE] = Field(
        20,
        ge=1,
        le=LARGEST_PAGE,
        description="Maximum number of architectures; `count`, paths, nodes and links cover all.",
    )
    calibrations: Annotated[int, WHOLE] = Field(
        5, ge=1, le=LARGEST_PAGE, description="Maximum number of calibrations per architecture."
    )


class RequirementsQuery(Requirements, TableQuestion):
    """Requirements in a query."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "task": ["Accuracy"],
                    "detector": ["CMOS"],
                    "mask": ["Single-Ap."],
                    "limit": 1,
                    "calibrations": 1,
                }
            ]
        }
    )


class RequirementsBody(Requirements, strict=True):
    """Requirements in a request body."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "task": ["Accuracy"],
                    "mask": ["Encoded"],
                    "exclude_detector": ["CCD"],
                    "limit": 1,
                    "calibrations": 1,
                }
            ]
        }
    )


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
    least_deg: float
    largest_deg: float
    meeting: int | None = Field(
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
    own_deg: float | None = Field(
        description="Own error: calibrated with true directions, over sensor units."
    )
    bench_deg: float = Field(description="Calibration-bench error used.")
    needs: list[str] = Field(description="Inputs that the calibration needs besides the sensor.")
    condition: str = Field(description="Condition with the maximum error.")
    field_deg: float | None = Field(description="Full field of view of the error.")
    nominal_deg: float | None = Field(description="RMS error under nominal conditions.")
    nominal: Nominal
    conditions: dict[str, float | None] = Field(
        description="RMS errors under the conditions to tolerate."
    )
    fov_deg: float | None = Field(description="Full field of view of the data set.")
    availability: float | None = Field(description="Lowest availability over the conditions.")
    latency_us: float | None = Field(
        description="Time per sample on this machine, microseconds; null if not timed."
    )
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


class Task(Shape):
    """A task of an architecture."""

    task: str
    studies: int
    advised: bool


class Advice(Shape):
    """A piece of the survey's advice."""

    id: str
    requirement: str
    value: str
    model_category: str
    extractor: str
    section: str
    section_name: str = Field(description="Name of the section, with printed number.")
    note: str


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
    tasks: list[Task]
    advised: bool = Field(description="Whether the survey advises it for these requirements.")
    advice: list[Advice]
    studies: list[str]
    best: Calibration = Field(description="The calibration with the lowest measured error.")
    pareto: bool = Field(description="Pareto: no other has both more studies and a lower error.")
    contradiction: str | None = Field(
        description="Sentence, if the most accurate calibration is not the one most studies used."
    )
    measures: list[TaskMeasure] = Field(description="Measures of the requested tasks.")
    count: int = Field(description="Calibrations that meet the requirements.")
    calibrations: list[Calibration]


class Regret(Shape):
    """Accuracy lost by the ranking: first calibration compared with the most accurate one."""

    first_deg: float | None
    best_deg: float
    ratio: float | None
    sentence: str


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
    relaxations: list[Relaxation]


class Recommendations(Shape):
    """Architectures for a set of requirements, their calibrations, and the studies behind them."""

    requirements: dict[str, Any]
    sort: str
    count: int = Field(description="Number of architectures that meet the requirements.")
    designs: int = Field(description="Number of their calibrations.")
    architectures: list[Architecture]
    contradictions: list[str] = Field(
        description="Sentences, where an architecture that is not advised has better results."
    )
    regret: Regret | None
    untimed: int = Field(
        description=(
            "Number of pipelines excluded by the latency limit because they were not timed."
        )
    )
    untried: dict[str, list[Pair]] = Field(
        description="Architectures without a data set that tests the required condition."
    )
    paths: list[Path]
    nodes: list[Node]
    links: list[Link]
    left_out: list[LeftOut] = Field(
        description="Studies not shown because an attribute is unknown."
    )
    blocked: Blocked | None
