"""Learning curves: own error of the leaders against the poses that calibrate them."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from api.schema.base import Shape, SortedQuestion, example, page_of
from api.schema.parameters import Several, several
from api.schema.words import DatasetName, ExtractorName, ModelName


class CurvePoint(Shape):
    """Errors with a number of poses, over draws and units; null if every draw was refused."""

    poses: int = Field(description="Number of calibration poses.")
    middle_deg: float | None = Field(description="Median RMS error over the draws.")
    least_deg: float | None = Field(description="Smallest RMS error over the draws.")
    largest_deg: float | None = Field(description="Largest RMS error over the draws.")
    availability: float | None = Field(description="Median availability on the test split.")
    refused: int = Field(description="Draws with poses that the model refused.")


class CurveRow(Shape):
    """How many poses a pipeline needs: a row of the table."""

    dataset: str
    extractor: str
    model: str
    needed_poses: int | None = Field(description="Poses needed by half of the random draws.")
    needed_low: int | None = Field(description="Poses needed in the best random draw.")
    needed_high: int | None = Field(description="Poses needed in the worst random draw.")
    error_poses: int | None = Field(description="Poses needed by the error criterion alone.")
    answers_poses: int | None = Field(description="Poses needed by availability alone.")
    poses: int = Field(description="Poses of the calibration split.")
    floor: Literal["fitted", "all", "none"] = Field(
        description="fitted: asymptote f of the fitted squared error f^2 + a poses^-b; all: error "
        "with all poses; none: more than all poses are needed."
    )
    floor_error_deg: float | None = Field(description="Error floor, RMS over units.")
    over_bound: float | None = Field(description="Error floor divided by the bound.")


class Curve(CurveRow):
    """Learning curve of a pipeline. Poses are null if more than all poses are needed."""

    place: int = Field(description="Rank among the data set's leading pipelines.")
    condition: str
    in_order: bool = Field(description="Whether the poses are a time series, used in order.")
    floor_low_deg: float | None = Field(description="Lower end of the 90 % range of fitted floors.")
    floor_high_deg: float | None = Field(description="Upper end of the 90 % range of floors.")
    exponent: float | None = Field(description="Exponent b of the fitted law.")
    misfit: float | None = Field(description="Relative residual of the fitted law.")
    bound_deg: float = Field(description="Bound for a unit known only through its calibration.")
    bench_deg: float | None = Field(description="Error of the standard bench; not in the curve.")
    all_deg: list[float | None] = Field(description="Own error with all poses, by sensor unit.")
    draws: int = Field(description="Random draws of poses, over all units.")
    reached: int = Field(description="Draws within 10 % of the error floor.")
    needed: list[int | None] = Field(description="Poses needed by each draw, unit after unit.")
    error_from: list[int | None] = Field(description="Poses needed by each draw, by error.")
    answers_from: list[int | None] = Field(description="Poses needed, by availability.")
    refusal: str = Field(description="Reason of the first refused draw; empty if none.")
    points: list[CurvePoint] = Field(description="Points of the curve, by number of poses.")


class CurvesQuery(SortedQuestion, rows=CurveRow):
    """Which learning curves."""

    model_config = example(dataset=["cmos-single-aperture"], limit=1)

    dataset: Several[DatasetName] = several("Only this data set.")
    extractor: Several[ExtractorName] = several("Only this extractor.")
    model: Several[ModelName] = several("Only this model.")


Curves = page_of(Curve, "Curves", "A page of learning curves.")
