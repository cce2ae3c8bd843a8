"""Learning curves: own error of the leaders against the poses that calibrate them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from api import columns
from api.http.models.base import Listing, Shape, TableQuestion
from api.http.models.parameters import (
    DEFAULT_PAGE,
    FIELDS,
    GIVEN,
    SORT,
    Cursor,
    Limit,
    Several,
    columns_of,
    several,
    sorting,
)
from api.http.models.words import DatasetName, ExtractorName, ModelName


class CurvesQuery(TableQuestion):
    """Which learning curves."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"dataset": ["cmos-single-aperture"], "limit": 1}]}
    )

    dataset: Several[DatasetName] = several("Only this data set.")
    extractor: Several[ExtractorName] = several("Only this extractor.")
    model: Several[ModelName] = several("Only this model.")
    sort: Annotated[str | None, sorting(columns.CURVES), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.CURVES)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class CurvePoint(Shape):
    """Errors with a number of poses, over draws and units; null if every draw was refused."""

    poses: int
    middle_deg: float | None = Field(description="Median RMS error over the draws.")
    least_deg: float | None = Field(description="Smallest RMS error over the draws.")
    largest_deg: float | None = Field(description="Largest RMS error over the draws.")
    availability: float | None = Field(description="Median availability on the test split.")
    refused: int = Field(description="Draws with poses that the model refused.")


class Curve(Shape):
    """Learning curve of a pipeline. Poses are null if more than all poses are needed."""

    dataset: str
    place: int = Field(
        description="Rank among the data set's leading pipelines, each with another model."
    )
    condition: str
    extractor: str
    model: str
    poses: int = Field(description="Poses of the calibration split.")
    in_order: bool = Field(description="Whether the poses are a time series, used in order.")
    floor: Literal["fitted", "all", "none"] = Field(
        description=(
            "fitted: asymptote f of the fitted squared error f^2 + a poses^-b; all: error "
            "with all poses; none: more than all poses are needed."
        )
    )
    floor_error_deg: float | None = Field(description="Error floor, RMS over units.")
    floor_low_deg: float | None = Field(description="Lower end of the 90 % range of fitted floors.")
    floor_high_deg: float | None = Field(
        description="Upper end of the 90 % range of fitted floors."
    )
    exponent: float | None = Field(description="Exponent b of the fitted law.")
    misfit: float | None = Field(description="Relative residual of the fitted law.")
    bound_deg: float = Field(
        description=(
            "Cramer-Rao bound of the published score, for a unit known only through its "
            "dark and flat frames."
        )
    )
    bench_deg: float | None = Field(
        description="Error of the standard calibration bench; not included in the curve."
    )
    over_bound: float | None = Field(description="Error floor divided by the bound.")
    all_deg: list[float | None] = Field(description="Own error with all poses, by sensor unit.")
    draws: int = Field(description="Random draws of poses, over all units.")
    reached: int = Field(description="Draws within 10 % of the error floor.")
    needed_poses: int | None = Field(
        description=(
            "Poses with which half of the random draws are within 10 % of the error floor "
            "and have 95 % availability."
        )
    )
    needed_low: int | None = Field(description="Poses needed in the best random draw.")
    needed_high: int | None = Field(description="Poses needed in the worst random draw.")
    error_poses: int | None = Field(description="Poses needed by the error criterion alone.")
    answers_poses: int | None = Field(
        description="Poses needed by the availability criterion alone."
    )
    needed: list[int | None] = Field(description="Poses needed by each draw, unit after unit.")
    error_from: list[int | None] = Field(
        description="Poses needed by each draw, error criterion alone."
    )
    answers_from: list[int | None] = Field(
        description="Poses needed by each draw, availability criterion alone."
    )
    refusal: str = Field(description="Reason of the first refused draw; empty if none.")
    points: list[CurvePoint]


class Curves(Listing):
    """A page of learning curves."""

    items: list[Curve]
