"""Pipelines or architectures side by side."""

from __future__ import annotations

from typing import Annotated, Literal, TypeVar

from pydantic import AfterValidator, Field

from api.schema.base import OfEdition, Shape, TableQuestion, example
from api.schema.parameters import GIVEN, OneOf
from api.schema.words import Condition, DatasetName
from benchmark.leaderboard.partial_answers import FINER
from registry.studies import facts

FEWEST, MOST = 2, 4
SEPARATOR = ":"
"""Between extractor and model, and between detector and mask."""

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

    model_config = example(
        dataset="cmos-single-aperture", pipeline=["bctm:spm", "mirror:homography"]
    )

    architecture: InOrder[Architecture] = Field(
        default_factory=list,
        description=f"Architectures as DETECTOR:MASK, {FEWEST} to {MOST}; each by its best "
        "pipeline.",
    )
    dataset: Annotated[DatasetName | None, GIVEN] = Field(None, description="Of pipelines.")
    pipeline: InOrder[Pipeline] = Field(
        default_factory=list, description=f"Pipelines as EXTRACTOR:MODEL, {FEWEST} to {MOST}."
    )
    condition: Annotated[Condition | None, GIVEN] = Field(None, description="By default the first.")


class PartialPipeline(Shape):
    """A pipeline of the same architecture with a much lower error."""

    dataset: str
    extractor: str
    model: str
    availability: float = Field(description="Availability.")


class FinerPipeline(PartialPipeline):
    """A pipeline with a much lower own error."""

    own_error_deg: float = Field(description="Own error: geometric mean over sensor units.")


class FinerThere(PartialPipeline):
    """A pipeline with a much lower error of unit 0 under a condition."""

    rms_all_answers_deg: float = Field(description="Unit 0 RMS, over all answers.")


class ConditionError(Shape):
    """Error of unit 0 under a condition; own errors are over all units, under the first."""

    rms_all_answers_deg: float | None = Field(description="Unit 0 RMS, over all answers.")
    availability: float | None
    partial_answer: FinerThere | None = Field(
        description="Pipeline of the architecture with the lowest error under this condition at "
        f"50 % availability or more; null unless the error is more than {FINER:g} times as large."
    )


class RingError(Shape):
    """Error in a ring of the field."""

    inner_deg: float = Field(description="Inner off-axis angle of the ring, degrees.")
    outer_deg: float = Field(description="Outer off-axis angle of the ring, degrees.")
    rms_deg: float


class ComparedRow(Shape):
    """What is compared of a pipeline: a row of the table."""

    detector: str
    mask: str
    dataset: str | None
    condition: str | None
    extractor: str | None
    model: str | None
    studies: list[str] = Field(description="Studies that used it on such a sensor.")
    own_error_deg: float | None = Field(
        description="Own error; RMS over the units measured elsewhere."
    )
    ratio_to_smallest: float | None = Field(description="Own error over the lowest compared.")
    height_mm: float | None = Field(description="Height of mask or lens; null if there is none.")
    own_at_1_mm_deg: float | None = Field(description="Own error scaled to a height of 1 mm.")
    bound_deg: float | None = Field(description="RMS Cramer-Rao bound for a known sensor unit.")
    over_bound: float | None = Field(description="Unit 0 RMS of all answers over its bound.")
    over_bound_se: float | None = Field(description="Standard error of that ratio.")
    on_bench_deg: float | None = Field(description="Error expected on the standard bench.")
    low_deg: float | None = Field(description="Smallest error over units.")
    high_deg: float | None = Field(description="Largest error over units.")
    availability: float | None
    false_detection_rate: float | None = Field(
        description="Share of unobservable samples answered."
    )
    latency_us: float | None = Field(description="Time per sample, microseconds.")
    time_ratio: float | None = Field(description="The same divided by that of the reference loop.")
    needed_poses: int | None = Field(description="Poses to be within 10 % of the error floor.")
    needed_low: int | None = Field(description="Poses needed in the best random draw.")
    needed_high: int | None = Field(description="Poses needed in the worst random draw.")
    poses: int | None = Field(description="Poses in the data set; null without a curve.")
    floor_error_deg: float | None = Field(description="Error floor of the learning curve.")
    half_fov_deg: float | None
    rank: int | None = Field(description="Rank on the leaderboard of the data set and condition.")
    status: Literal["ok", "refused", "failed", "none"]
    reason: str | None = Field(description="Reason for a missing score.")
    partial_answer: FinerPipeline | None = Field(
        description="Pipeline of the architecture with the lowest error at 50 to 95 % "
        f"availability; null unless the error is more than {FINER:g} times as large."
    )


class Compared(ComparedRow):
    """A pipeline, or the best one of an architecture. Numbers are null if undefined."""

    proposed: list[str] | None = Field(description="Studies with this architecture.")
    unit_rms_deg: list[float | None] | None = Field(description="Error on each sensor unit.")
    conditions: dict[str, ConditionError] = Field(description="Unit 0 RMS by condition.")
    rings: list[RingError] = Field(description="Unit 0 RMS by off-axis angle.")


class Comparison(Shape):
    """Compared pipelines or architectures, in the requested order."""

    dataset: str | None = Field(description="Null if architectures are compared.")
    condition: str | None
    items: list[Compared]


class MaskAtEqualHeight(Shape):
    """A mask over the common detector: a row of the table. Numbers are null if it has none."""

    design: str = Field(description="Name of the design; two may have the same mask.")
    mask: str
    height_mm: float = Field(description="Height of the mask over the detector.")
    half_fov_deg: float = Field(description="Half field of view, each projection angle.")
    units: int = Field(description="Sensor units; another one chose the pipeline.")
    extractor: str = Field(description="Extractor; empty if there is none.")
    model: str = Field(description="Model; empty if there is none.")
    own_error_deg: float | None = Field(description="Own error: geometric mean over sensor units.")
    own_low_deg: float | None = Field(description="Smallest own error of a unit.")
    own_high_deg: float | None = Field(description="Largest own error of a unit.")
    flight_error_deg: float | None = Field(
        description="Error in flight: geometric mean over sensor units above 95 % availability."
    )
    flight_low_deg: float | None = Field(
        description="Smallest error in flight of a unit; null if one is below 95 % availability."
    )
    flight_high_deg: float | None = Field(description="Largest, likewise.")
    bound_deg: float | None = Field(description="RMS Cramer-Rao bound for a known sensor unit.")
    reason: str = Field(description="Why there is no error; empty if there is one.")


class EqualHeights(Shape):
    """Masks at equal height, detector and field, by error in flight."""

    detector: str = Field(description="The common detector in words.")
    items: list[MaskAtEqualHeight]
