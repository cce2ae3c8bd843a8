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

    dataset: Several[DatasetName] = several("Only this standard data set.")
    extractor: Several[ExtractorName] = several("Only this extractor.")
    model: Several[ModelName] = several("Only this model.")
    sort: Annotated[str | None, sorting(columns.CURVES), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.CURVES)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class CurvePoint(Shape):
    """Errors after so many poses, over draws and units; null where every draw was refused."""

    poses: int
    middle_deg: float | None = Field(description="Median of the draws' root mean square errors.")
    least_deg: float | None = Field(description="Smallest of them.")
    largest_deg: float | None = Field(description="Largest of them.")
    availability: float | None = Field(description="Median answered share of the test split.")
    refused: int = Field(description="Draws whose poses the model refused.")


class Curve(Shape):
    """The learning curve of one pipeline. Poses are null where all there are are too few."""

    dataset: str
    place: int = Field(description="Among the data set's leaders, each with another model.")
    condition: str
    extractor: str
    model: str
    poses: int = Field(description="That the calibration split has.")
    in_order: bool = Field(description="Whether they are a time series, taken in its order.")
    floor: Literal["fitted", "all", "none"] = Field(
        description="fitted: where the fitted law of the squared error, f^2 + a poses^-b, ends; "
        "all: the error with all poses, where no law is fitted; none: all poses are too few."
    )
    floor_error_deg: float | None = Field(description="The floor, root mean square over units.")
    floor_low_deg: float | None = Field(description="Where nine in ten fitted floors lie, from.")
    floor_high_deg: float | None = Field(description="To.")
    exponent: float | None = Field(description="b of the law.")
    misfit: float | None = Field(description="By how much the law misses the errors, relative.")
    bound_deg: float = Field(
        description="Cramer-Rao bound of the pipeline's published score, for a unit that is known "
        "by its dark and flat readings where there are any."
    )
    bench_deg: float | None = Field(
        description="Fixed error of the standard bench's directions, which the curve is without."
    )
    over_bound: float | None = Field(description="Floor over bound.")
    all_deg: list[float | None] = Field(description="Own error with all poses, by unit.")
    draws: int = Field(description="Draws of poses, over all units.")
    reached: int = Field(description="Draws that come within 10 % of the floor.")
    needed_poses: int | None = Field(
        description="Poses from which on half of the draws err by at most 1.1 floors and answer "
        "95 % of the test split."
    )
    needed_low: int | None = Field(description="The same of the first draw.")
    needed_high: int | None = Field(description="The same of the last draw.")
    error_poses: int | None = Field(description="The same of half of the draws, by error alone.")
    answers_poses: int | None = Field(description="The same, by answers alone.")
    needed: list[int | None] = Field(description="By draw, unit after unit.")
    error_from: list[int | None] = Field(description="By draw, by error alone.")
    answers_from: list[int | None] = Field(description="By draw, by answers alone.")
    refusal: str = Field(description="Why the first refused draw was; empty where none was.")
    points: list[CurvePoint]


class Curves(Listing):
    """A page of learning curves."""

    items: list[Curve]
