"""Requirements on a sensor, and the paths that meet them."""

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
    return several(f"Only paths with one of these values of {attribute}.")


def _unwanted(attribute: str) -> Any:
    return several(f"No path with one of these values of {attribute}.")


Number = Annotated[float | None, NUMBER]


class Requirements(OfEdition):
    """What a sensor shall have."""

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
        description="RMS error at most this, in degrees, over the field asked for and all it shall "
        "survive: measured; where nothing is measured, a stated accuracy as the RMS of its kind "
        "(unspecified: as printed), never a precision.",
    )
    min_fov_deg: Number = Field(
        None,
        gt=0,
        le=360,
        description="Full field of view at least this, in degrees: measured; stated where nothing "
        "is measured.",
    )
    max_latency_us: Number = Field(
        None,
        gt=0,
        le=1e12,
        description="Extraction and prediction of one sample at most this, in microseconds.",
    )
    min_availability: Number = Field(
        None,
        gt=0,
        le=1,
        description="Answered share of the samples at least this, nominal and surviving: measured.",
    )
    survive: Several[words.Hazard] = several(
        "Only designs that a data set tries under each of these, and that answer often enough "
        "under them, within the largest error if one is asked for."
    )
    properties: Several[words.Property] = several(
        "Only extractors that have all of these in the survey's assessment, in part at least."
    )
    exclude_needs: Several[words.Need] = several(
        "No calibration that reads one of these beside the sensor."
    )
    bench_deg: Number = Field(
        None,
        ge=0,
        le=180,
        description="Fixed error of the calibration bench, in degrees: by default that of each "
        "data set's standard bench; 0 for own errors.",
    )
    confidence: Number = Field(
        None,
        ge=0.5,
        le=0.999,
        description="Share of sensor units and benches on which the largest error has to be kept; "
        "0.9 by default.",
    )
    sort: Sort = Field(
        "advice",
        description="Order of the architectures: advised or used ones first, by the measure of "
        "the tasks asked for or by error (advice); backed by most studies (support); smallest "
        "error (measured). Calibrations come by error but for support.",
    )
    limit: Annotated[int, WHOLE] = Field(
        20,
        ge=1,
        le=LARGEST_PAGE,
        description="Architectures to return; `count`, paths, nodes and links tell of all.",
    )
    calibrations: Annotated[int, WHOLE] = Field(
        5, ge=1, le=LARGEST_PAGE, description="Calibrations to return of each architecture."
    )


class RequirementsQuery(Requirements, TableQuestion):
    """What a sensor shall have, in a query."""

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
    """What a sensor shall have, in a body: numbers are no text there."""

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
    """The score under the first condition of the data set, over its whole field."""

    condition: str
    rms_deg: float | None
    bound_deg: float | None
    over_bound: float | None
    repeatability_deg: float | None
    availability: float | None = Field(
        description="Answered share of the samples whose direction is observable."
    )
    false_sun: float | None = Field(description="Answered share of the other samples.")


class Units(Shape):
    """Own errors over units of the sensor that were measured, the standard one among them."""

    count: int
    least_deg: float
    largest_deg: float
    meeting: int | None = Field(
        description="How many of ten units meet the largest error asked for; null if none is."
    )
    of: int = Field(description="Ten; of what was measured on fewer than five, by their spread.")


class Finer(Shape):
    """A pipeline on the same sensor that errs far less, but answers too seldom to be judged."""

    dataset: str
    extractor: str
    model: str
    error_deg: float = Field(description="Its largest error where it answers.")
    availability: float = Field(description="Its least answered share.")


class Measured(Shape):
    """A pipeline on a data set, judged over the field and the conditions asked for."""

    dataset: str
    extractor: str
    model: str
    error_deg: float | None = Field(
        description="What it is judged by: its largest error, nominal and under all it shall "
        "survive; where a largest error or a bench is asked for, the error that the asked share of "
        "units and benches keeps within; null where it answers too seldom."
    )
    own_deg: float | None = Field(
        description="The same calibrated with true directions, over sensor units."
    )
    bench_deg: float = Field(description="Fixed error of the bench that it is judged on.")
    needs: list[str] = Field(description="What its calibration reads beside the sensor.")
    condition: str = Field(description="Where that was measured.")
    field_deg: float | None = Field(description="Full field that the error holds over.")
    nominal_deg: float | None = Field(description="The error of the first condition alone.")
    nominal: Nominal
    conditions: dict[str, float | None] = Field(
        description="Errors under what it shall survive, by condition."
    )
    fov_deg: float | None = Field(description="Full field of view of the data set.")
    availability: float | None = Field(description="Least answered share of all these.")
    latency_us: float | None = Field(
        description="Of one sample on this machine, microseconds; null where it is not timed."
    )
    units: Units | None
    finer: Finer | None = Field(
        description="Of what keeps the other requirements on this sensor, but answers too seldom "
        f"to be judged, at least {100 * LEAST_ANSWERED:.0f} % though: what errs least, where the "
        f"error here is more than {FINER:g} times as large."
    )


class Calibration(Shape):
    """An extractor, compensations and a model, as values of the taxonomy, with their evidence."""

    rank: int
    extractor: str
    compensations: list[str]
    model: str
    advised: list[str] = Field(description="The survey's advice that names it.")
    studies: list[str] = Field(description="Studies that stand for it; empty: in no study.")
    with_model: int = Field(description="Studies that stand for its compensations and model.")
    support: float = Field(
        description="Geometric mean of the architecture's studies, `with_model` and `studies`."
    )
    measured: Measured | None = Field(description="Its best pipeline that meets the requirements.")
    other_datasets: list[Measured] = Field(description="Its best on each other data set.")
    basis: dict[str, Literal["measured", "stated", "studies", "advised", "assessed"]] = Field(
        description="On what each requirement was judged."
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
    section_name: str = Field(description="What the label names, with its number in print.")
    note: str


class TaskMeasure(Shape):
    """What an architecture is ranked by for a task."""

    task: str
    value: float | None
    unit: str
    basis: Literal["measured", "published"]
    built: int = Field(description="Built sensors that it is the median of.")
    words: str


class Architecture(Shape):
    """A detector behind a mask, with its evidence, and its calibrations, best first."""

    rank: int
    detector: str
    mask: str
    tasks: list[Task]
    advised: bool = Field(description="Whether the survey advises it for what is asked.")
    advice: list[Advice]
    studies: list[str]
    best: Calibration = Field(description="The calibration that errs least.")
    pareto: bool = Field(description="Whether none has more studies and a smaller error.")
    contradiction: str | None = Field(
        description="Where the best measured calibration is not what most studies stand for."
    )
    measures: list[TaskMeasure] = Field(description="Own measures of the tasks asked for.")
    count: int = Field(description="Calibrations that meet the requirements.")
    calibrations: list[Calibration]


class Regret(Shape):
    """By how much the first calibration named errs more than the best one measured."""

    first_deg: float | None
    best_deg: float
    ratio: float | None
    sentence: str


class Pair(Shape):
    """A detector behind a mask."""

    detector: str
    mask: str


class Path(Shape):
    """A way that studies behind the answer took."""

    task: str
    detector: str
    mask: str
    model: str
    extractor: str
    studies: list[str]


class Relaxation(OpenShape):
    """A change of the requirements that leaves architectures."""

    constraint: str
    architectures: int
    words: str


class Blocked(Shape):
    """Why nothing is left."""

    constraint: str
    detail: str
    relaxations: list[Relaxation]


class Recommendations(Shape):
    """Architectures for a set of requirements, their calibrations, and the studies behind them."""

    requirements: dict[str, Any]
    sort: str
    count: int = Field(description="Architectures that meet the requirements, beyond `limit` too.")
    designs: int = Field(description="Their calibrations, all together.")
    architectures: list[Architecture]
    contradictions: list[str] = Field(
        description="Where an architecture that the survey does not advise does better."
    )
    regret: Regret | None
    untimed: int = Field(
        description="Measured pipelines that a limit on latency cannot judge: not timed here."
    )
    untried: dict[str, list[Pair]] = Field(
        description="Architectures that no data set tries under what they shall survive."
    )
    paths: list[Path]
    nodes: list[Node]
    links: list[Link]
    left_out: list[LeftOut] = Field(description="Studies on no path for want of a value.")
    blocked: Blocked | None
