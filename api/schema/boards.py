"""Leaderboard summary: the best of each architecture, and an overview of the parts."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from api.schema.base import Listing, Shape, SortedQuestion, TableQuestion, example
from api.schema.parameters import OneOf, Several, several
from api.schema.words import Detector, Mask
from benchmark.leaderboard.overview import ROLES
from benchmark.leaderboard.partial_answers import FINER

RoleName = Annotated[str, OneOf(lambda: ROLES)]


class OverviewQuery(TableQuestion):
    """Which parts, counted on which boards."""

    model_config = example(role=["extractor"], detector=["QPD"])

    role: Several[RoleName] = several("Only parts of this role.")
    detector: Several[Detector] = several("Only data sets with this detector.")
    mask: Several[Mask] = several("Only data sets with this mask.")


class HeightOrder(Shape):
    """Rank correlation of error and 1/height over architectures."""

    correlation: float = Field(description="Spearman's rank correlation.")
    p_value: float = Field(description="Share of permutations with such a correlation.")
    sensors: int = Field(description="Architectures compared.")
    without: int = Field(description="Architectures without a height or an error, left out.")
    sentence: str = Field(description="The same in words; empty unless most of the order follows.")


class BestOfArchitecture(Shape):
    """The best pipeline of an architecture under the first condition of its data sets.

    On the data set with the lowest error. Numbers are null where
    undefined, all of them where nothing has an error.
    """

    detector: str
    mask: str
    datasets: list[str] = Field(description="Data sets of the architecture.")
    dataset: str | None = Field(description="The data set with the lowest error.")
    half_fov_deg: float | None
    extractor: str | None
    model: str | None
    studies: list[str] = Field(description="Studies that used this pipeline on the architecture.")
    flight_error_deg: float | None = Field(
        description="Error in flight: geometric mean over sensor units; null if not flown."
    )
    flight_low_deg: float | None = Field(description="Smallest error in flight of a unit.")
    flight_high_deg: float | None = Field(description="Largest error in flight of a unit.")
    own_error_deg: float | None = Field(description="Own error: geometric mean over sensor units.")
    height_mm: float | None = Field(description="Height of mask or lens; null if there is none.")
    own_at_1_mm_deg: float | None = Field(
        description="Own error at a height of 1 mm, as if all of it went with 1/height."
    )
    flight_at_1_mm_deg: float | None = Field(description="Error in flight, scaled likewise.")
    own_se: float | None = Field(description="Relative standard error of the own error.")
    quoted_deg: float | None = Field(description="Error on odd units of the best on even units.")
    on_bench_deg: float | None = Field(description="Error expected on the standard bench.")
    on_bench_basis: Literal["measured", "estimated"] | None = Field(description="How it is known.")
    rms_deg: float | None = Field(description="Unit 0 RMS, over answers to observable samples.")
    bound_deg: float | None = Field(description="RMS Cramer-Rao bound for a known sensor unit.")
    over_bound: float | None = Field(description="Unit 0 RMS of all answers over its bound.")
    over_bound_se: float | None = Field(description="Standard error of that ratio.")
    bound_unit_deg: float | None
    over_bound_unit: float | None = Field(description="Unit 0 RMS of all answers over that bound.")
    availability: float | None = Field(description="Share of observable samples answered.")
    unit_rms_deg: list[float | None] | None = Field(description="RMS of all answers by unit.")
    others_low_deg: float | None = Field(description="Smallest error of the other units.")
    others_high_deg: float | None = Field(description="Largest error of the other units.")
    runner_up_extractor: str | None = Field(description="Extractor of the one that ranks next.")
    runner_up_model: str | None = Field(description="Model of the pipeline that ranks next.")
    runner_up_own_error_deg: float | None = Field(
        description="Own error of the one that ranks next."
    )
    runner_up_unit_rms_deg: list[float | None] | None = Field(description="Its errors by unit.")
    first_group: int = Field(description="Pipelines that a paired test cannot separate.")
    tie: bool = Field(description="Whether the runner-up is tied with the best.")
    units_ahead: int | None = Field(description="Units on which the best has the lower error.")
    units_compared: int = Field(description="Units on which both were scored.")
    partial_dataset: str | None = Field(
        description="Data set of the pipeline with the lowest error at 50 to 95 % availability; "
        f"null unless the best has more than {FINER:g} times its error."
    )
    partial_extractor: str | None = Field(description="Extractor of that pipeline.")
    partial_model: str | None = Field(description="Model of that pipeline.")
    partial_own_error_deg: float | None = Field(description="Its own error, degrees.")
    partial_over_bound: float | None = Field(description="Unit 0: its RMS divided by the bound.")
    partial_availability: float | None = Field(description="Availability of that pipeline.")


class Architectures(Listing):
    """A page of architectures, by detector and mask."""

    items: list[BestOfArchitecture]
    height_order: HeightOrder | None = Field(
        description="How far errors in flight follow 1/height, over all items of the selection."
    )


class PartOverview(Shape):
    """Number of data sets on which a part of a pipeline is near the bound."""

    role: Literal["extractor", "compensation", "model"]
    part: str = Field(description="Name of the implementation.")
    taxonomy: str
    boards: int = Field(description="Number of data sets with a bound on which it ran.")
    answered: int = Field(description="Of these, data sets with a pipeline at 95 % availability.")
    within_1_5: int = Field(description="Of these, data sets within 1.5 times the bound.")
    within_3: int = Field(description="Boards on which the error is at most 3 times the bound.")
    within_10: int = Field(description="Boards on which the error is at most 10 times the bound.")
    share_1_5: float = Field(description="`within_1_5` over `boards`.")
    share_3: float = Field(description="Share of data sets within 3 times the bound.")
    share_10: float = Field(description="Share of data sets within 10 times the bound.")
    median_over_bound: float | None = Field(description="Median of error divided by bound.")
    leads: int = Field(description="Number of data sets on which it is part of the best pipeline.")
    reachable_10: int = Field(description="Data sets with any pipeline within 10 times.")


class Overview(Shape):
    """Share of data sets on which each part of a pipeline is near the bound."""

    says: str = Field(description="Description of the aggregation.")
    within: list[float] = Field(description="Limits, as multiples of the bound.")
    boards: int = Field(description="Number of data sets counted, nominal condition.")
    parts: list[PartOverview] = Field(description="Extractors, compensations and models.")


class ArchitecturesQuery(SortedQuestion, rows=BestOfArchitecture):
    """Which architectures."""

    model_config = example(detector=["QPD"], limit=1)

    detector: Several[Detector] = several("Only this detector.")
    mask: Several[Mask] = several("Only this mask.")
