"""Pipelines or architectures side by side."""

from __future__ import annotations

from typing import Annotated, Literal, TypeVar

from pydantic import AfterValidator, ConfigDict, Field

from api.comparing import FEWEST, MOST, SEPARATOR
from api.http.models.base import Shape, TableQuestion
from api.http.models.parameters import GIVEN, OneOf
from api.http.models.studies import OfEdition
from api.http.models.words import Condition, DatasetName
from registry.measured_pipelines import FINER
from registry.studies import facts

Word = TypeVar("Word")
InOrder = Annotated[
    list[Word], Field(max_length=MOST), AfterValidator(lambda given: list(dict.fromkeys(given)))
]


def _architectures() -> tuple[str, ...]:
    values = facts().taxonomy.values
    return tuple(f"{d}{SEPARATOR}{m}" for d in values("detector") for m in values("mask"))


Architecture = Annotated[str, OneOf(_architectures)]
Pipeline = Annotated[str, Field(min_length=3, max_length=120)]


class CompareQuery(OfEdition, TableQuestion):
    """What is compared: pipelines on a data set, or architectures."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "dataset": "cmos-single-aperture",
                    "pipeline": ["bctm:spm", "mirror:homography"],
                }
            ]
        }
    )

    architecture: InOrder[Architecture] = Field(
        default_factory=list,
        description=f"Detector and mask with a colon between; {FEWEST} to {MOST} of them, each "
        "compared by its best pipeline.",
    )
    dataset: Annotated[DatasetName | None, GIVEN] = Field(
        None, description="Standard data set of the pipelines."
    )
    pipeline: InOrder[Pipeline] = Field(
        default_factory=list,
        description="Names of extractor and model with a colon between, as its leaderboard has "
        f"them; {FEWEST} to {MOST} of them.",
    )
    condition: Annotated[Condition | None, GIVEN] = Field(
        None, description="Of the data set; its first by default."
    )


class FinerPipeline(Shape):
    """A pipeline of the same architecture that errs far less."""

    dataset: str
    extractor: str
    model: str
    rms_deg: float
    availability: float = Field(description="Share of the samples that its error is of.")


class ConditionError(Shape):
    """Error under a condition."""

    rms_deg: float | None
    availability: float | None
    finer: FinerPipeline | None = Field(
        description="Of an architecture: the pipeline of the data set that errs least under this "
        "condition of those that answer half of the samples or more; null unless the error is more "
        f"than {FINER:g} times as large."
    )


class RingError(Shape):
    """Error in a ring of the field."""

    inner_deg: float
    outer_deg: float
    rms_deg: float


class Compared(Shape):
    """A pipeline, or the best one of an architecture. Numbers are null where undefined."""

    detector: str
    mask: str
    dataset: str | None
    condition: str | None
    extractor: str | None
    model: str | None
    studies: list[str] = Field(description="Mapped studies that used it on such a sensor.")
    proposed: list[str] | None = Field(
        description="Of an architecture: all mapped studies that have it."
    )
    rms_deg: float | None
    over_least: float | None = Field(description="RMS error over the least of those compared.")
    bound_deg: float | None = Field(description="Cramer-Rao bound, rms, with the unit known.")
    over_bound: float | None
    over_bound_se: float | None = Field(description="Standard error of that ratio.")
    own_deg: float | None = Field(description="Own error: geometric mean over sensor units.")
    on_bench_deg: float | None = Field(
        description="Error expected when calibrated on the standard bench."
    )
    unit_rms_deg: list[float | None] | None = Field(description="Error on each unit.")
    low_deg: float | None = Field(description="Smallest error of a unit.")
    high_deg: float | None = Field(description="Largest.")
    availability: float | None
    false_sun: float | None
    latency_us: float | None = Field(description="Time of a sample on this machine, if timed.")
    time_ratio: float | None = Field(description="The same over the time of a reference.")
    half_fov_deg: float | None
    rank: int | None = Field(description="Place on the leaderboard of its data set and condition.")
    status: Literal["ok", "refused", "failed", "none"]
    reason: str | None = Field(description="Why there is no score.")
    needed_poses: int | None = Field(
        description="Calibration poses after which it is within 10 % of its floor; null where it "
        "has no learning curve, or all poses are too few."
    )
    needed_low: int | None
    needed_high: int | None
    poses: int | None = Field(description="Poses that the data set gives; null without a curve.")
    floor_error_deg: float | None = Field(description="Where its learning curve ends.")
    finer: FinerPipeline | None = Field(
        description="Of an architecture: what errs least of the pipelines that answer half of the "
        "samples or more, but too seldom to rank first; null unless the error is more than "
        f"{FINER:g} times as large."
    )
    conditions: dict[str, ConditionError] = Field(description="Its error by condition.")
    rings: list[RingError] = Field(description="Its error by angle off the boresight.")


class Comparison(Shape):
    """What is compared, in the order asked for."""

    dataset: str | None = Field(description="Null where architectures are compared.")
    condition: str | None
    items: list[Compared]
