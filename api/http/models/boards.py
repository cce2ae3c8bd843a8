"""What the leaderboard comes to: the best of each architecture, and an overview of the parts."""

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
    OneOf,
    Several,
    columns_of,
    several,
    sorting,
)
from api.http.models.words import Detector, Mask
from benchmark.leaderboard.overview import ROLES
from registry.measured_pipelines import FINER

RoleName = Annotated[str, OneOf(lambda: ROLES)]


class ArchitecturesQuery(TableQuestion):
    """Which architectures."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"detector": ["QPD"], "limit": 1}]})

    detector: Several[Detector] = several("Only this detector.")
    mask: Several[Mask] = several("Only this mask.")
    sort: Annotated[str | None, sorting(columns.ARCHITECTURES), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.ARCHITECTURES)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class OverviewQuery(TableQuestion):
    """Which parts, counted on which boards."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"role": ["extractor"], "detector": ["QPD"]}]}
    )

    role: Several[RoleName] = several("Only parts of this role.")
    detector: Several[Detector] = several("Count boards of this detector only.")
    mask: Several[Mask] = several("Count boards of this mask only.")


class BestOfArchitecture(Shape):
    """The best pipeline of an architecture under the first condition of its data sets.

    Of several data sets the one counts whose best pipeline errs least. Numbers are null where
    undefined, all of them where nothing has an error.
    """

    detector: str
    mask: str
    datasets: list[str] = Field(description="Data sets of the architecture.")
    dataset: str | None = Field(description="The one whose best pipeline errs least.")
    half_fov_deg: float | None
    extractor: str | None
    model: str | None
    studies: list[str] = Field(
        description="Mapped studies that used this pipeline on the architecture."
    )
    rms_deg: float | None = Field(description="RMS error on the standard unit.")
    own_deg: float | None = Field(description="Own error: geometric mean over sensor units.")
    own_se: float | None = Field(description="Its relative standard error.")
    quoted_deg: float | None = Field(
        description="Error on the odd units of what errs least on the even ones."
    )
    on_bench_deg: float | None = Field(
        description="Error expected when calibrated on the standard bench."
    )
    on_bench_basis: Literal["measured", "estimated"] | None
    bound_deg: float | None = Field(description="Cramer-Rao bound, rms, with the unit known.")
    over_bound: float | None = Field(description="RMS error over the bound.")
    over_bound_se: float | None = Field(description="Standard error of that ratio.")
    bound_unit_deg: float | None
    over_bound_unit: float | None
    availability: float | None = Field(description="Answered share of the observable samples.")
    unit_rms_deg: list[float | None] | None = Field(
        description="Error over all answers on each unit, the standard one first."
    )
    others_low_deg: float | None = Field(
        description="Smallest of these on a unit other than the standard one."
    )
    others_high_deg: float | None = Field(description="Largest of these.")
    runner_up_extractor: str | None = Field(
        description="Of the pipeline that ranks next on the data set."
    )
    runner_up_model: str | None
    runner_up_own_deg: float | None
    runner_up_unit_rms_deg: list[float | None] | None
    first_group: int = Field(
        description="How many pipelines of the data set a paired test does not tell apart."
    )
    tie: bool = Field(description="Whether the runner-up is one of them.")
    units_ahead: int | None = Field(description="Units on which the best errs less.")
    units_compared: int = Field(description="Units on which both have an error.")
    finer_dataset: str | None = Field(
        description="Of the pipeline that errs least of those that answer half of the samples or "
        "more, but too seldom to rank first; null unless the best errs by more than "
        f"{FINER:g} times as much."
    )
    finer_extractor: str | None
    finer_model: str | None
    finer_rms_deg: float | None
    finer_over_bound: float | None
    finer_availability: float | None


class Architectures(Listing):
    """A page of architectures, by detector and mask."""

    items: list[BestOfArchitecture]


class PartOverview(Shape):
    """How often a part of a pipeline comes near the bound."""

    role: Literal["extractor", "compensation", "model"]
    part: str = Field(description="Name of its implementation.")
    taxonomy: str
    boards: int = Field(description="Boards with a bound on which it ran.")
    answered: int = Field(description="Those on which a pipeline with it answers often enough.")
    within_1_5: int = Field(description="Those on which the best of these is within 1.5 bounds.")
    within_3: int
    within_10: int
    share_1_5: float = Field(description="`within_1_5` over `boards`.")
    share_3: float
    share_10: float
    median_over_bound: float | None = Field(description="Over the boards answered.")
    leads: int = Field(description="Boards on which it is part of the pipeline in front.")
    reachable_10: int = Field(
        description="Of `boards`, those on which any pipeline is within 10 bounds."
    )


class Overview(Shape):
    """The share of boards on which each part of a pipeline comes near the bound."""

    says: str = Field(description="How it aggregates, in words.")
    within: list[float] = Field(description="The limits, in times the bound.")
    boards: int = Field(description="Boards that count: data sets under their first condition.")
    parts: list[PartOverview]
