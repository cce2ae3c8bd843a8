"""Requirements on a sensor, and the paths that meet them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from api.http.models import words
from api.http.models.base import OpenShape, Question, Shape
from api.http.models.flows import LeftOut, Link, Node
from api.http.models.parameters import LARGEST_PAGE, NUMBER, WHOLE, Several, several


def _wanted(attribute: str) -> Any:
    return several(f"Only paths with one of these values of {attribute}.")


def _unwanted(attribute: str) -> Any:
    return several(f"No path with one of these values of {attribute}.")


Number = Annotated[float | None, NUMBER]


class Requirements(Question):
    """What a sensor shall have, in a query."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"task": ["Accuracy"], "detector": ["CMOS"], "mask": ["Single-Ap."], "limit": 1}
            ]
        }
    )

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
        description="RMS error at most this, in degrees: measured in the condition, or stated.",
    )
    min_fov_deg: Number = Field(
        None,
        gt=0,
        le=360,
        description="Full field of view at least this, in degrees: measured, or stated.",
    )
    max_latency_us: Number = Field(
        None,
        gt=0,
        le=1e12,
        description="Extraction and prediction of one sample at most this, in microseconds.",
    )
    condition: words.Condition = Field(
        "nominal",
        description="Condition of the data sets in which measured performance is read.",
    )
    limit: Annotated[int, WHOLE] = Field(
        20,
        ge=1,
        le=LARGEST_PAGE,
        description="Paths to return; `count`, nodes and links tell of all.",
    )


class RequirementsBody(Requirements, strict=True):
    """What a sensor shall have, in a body: numbers are no text there."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"task": ["Accuracy"], "mask": ["Encoded"], "exclude_detector": ["CCD"], "limit": 1}
            ]
        }
    )


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
