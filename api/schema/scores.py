"""Scores and leaderboards."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from api.schema.base import OpenShape, Shape, SortedQuestion, TableQuestion, example, page_of
from api.schema.parameters import (
    DEFAULT_PAGE,
    GIVEN,
    NUMBER,
    Cursor,
    Flag,
    Limit,
    OneOf,
    Several,
    several,
)
from api.schema.words import Condition, DatasetName, ExtractorName, ModelName
from benchmark.metrics.rings import EDGES_DEG

FIELD_EDGES = tuple(str(edge) for edge in EDGES_DEG[1:])


class WholeLeaderboardQuery(TableQuestion):
    """Which part of the leaderboard of all data sets."""

    model_config = example(limit=1)

    whole: Flag = Field(default=False, description="Return all rows at once (over 10 MB).")
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class Place(OpenShape):
    """A pipeline on a data set in a condition."""

    dataset: str
    condition: str
    extractor: str
    model: str


class Score(Place):
    """What a pipeline achieves on a data set in a condition. Numbers are null where undefined.

    Errors, the bound and their ratio are over the same samples: observable and answered.
    """

    status: Literal["ok", "refused", "failed"]
    reason: str = Field(description="Reason for a missing score; empty otherwise.")
    rms_deg: float | None = Field(description="RMS over answers to observable samples.")
    rms_all_answers_deg: float | None = Field(
        description="RMS over all answers; own errors' basis."
    )
    aligned_deg: float | None = Field(description="RMS error after boresight alignment.")
    bound_deg: float | None = Field(description="RMS Cramer-Rao bound for a known sensor unit.")
    bound_unit_deg: float | None = Field(description="Bound for a unit known by references.")
    availability: float | None = Field(description="Share of observable samples answered.")
    false_detection_rate: float | None = Field(
        description="Share of unobservable samples answered."
    )
    dataset_version: int = Field(description="Version of the data set.")
    unit: int = Field(description="Sensor unit; 0 is the standard unit.")
    detector: str
    mask: str
    half_fov_deg: float | None
    extractor_taxonomy: str
    extractor_version: int
    model_taxonomy: str
    model_version: int = Field(description="Version of the model.")
    n_calibration: int | None = Field(description="Number of samples in the calibration split.")
    n_test: int | None = Field(description="Number of samples in the test split.")
    n_observable: int | None = Field(description="Number of observable test samples.")
    median_deg: float | None = Field(description="Median separation angle, degrees.")
    p95_deg: float | None = Field(description="95th percentile of the separation angle, degrees.")
    p997_deg: float | None = Field(description="99.7th percentile of the separation angle.")
    max_deg: float | None = Field(description="Largest separation angle, degrees.")
    bias_alpha_deg: float | None = Field(description="Mean error of alpha, degrees.")
    bias_beta_deg: float | None = Field(description="Mean error of beta, degrees.")
    rms_alpha_deg: float | None = Field(description="Root mean square error of alpha, degrees.")
    rms_beta_deg: float | None = Field(description="Root mean square error of beta, degrees.")
    repeatability_deg: float | None = Field(description="Spread of answers at a fixed pose.")
    over_bound: float | None = Field(description="RMS of all answers over the bound.")
    over_bound_se: float | None = Field(description="Standard error of that ratio.")
    over_bound_unit: float | None = Field(description="The same RMS divided by that bound.")
    rms_0_10_deg: float | None = None
    rms_10_20_deg: float | None = None
    rms_20_30_deg: float | None = None
    rms_30_40_deg: float | None = None
    rms_40_50_deg: float | None = None
    rms_50_60_deg: float | None = None
    rms_60_70_deg: float | None = None
    rms_70_90_deg: float | None = None
    rms_90_180_deg: float | None = None
    metric_version: int | None = Field(None, description="Version of the metrics.")


class Rank(OpenShape):
    """Rank in a data set and condition."""

    rank: int | None = Field(
        description="Rank by own error, or by the error over the requested field. Pipelines below "
        "95 % availability rank last; null without an error."
    )
    group: int | None = Field(
        None,
        description="1 for pipelines that a paired test over units cannot separate from the "
        "leader, 2 for the next such group, and so on; null with fewer than five units.",
    )
    tied: bool = Field(description="Whether the rank is shared.")


# Members of a class stand behind those of the classes named after it.
class LeaderboardRow(Score, Rank):
    """A score with its rank."""

    own_error_deg: float | None = Field(
        None, description="Geometric mean of `rms_all_answers_deg` over units."
    )
    own_se: float | None = Field(None, description="Relative standard error of the own error.")
    on_bench_deg: float | None = Field(None, description="Error expected on the standard bench.")
    on_bench_basis: Literal["measured", "estimated"] | None = Field(
        None,
        description="measured on twenty random benches, or estimated as the root sum of squares "
        "of own error and bench error.",
    )
    low_deg: float | None = Field(description="Smallest error over units; null with one unit.")
    high_deg: float | None = Field(description="Largest error over units.")
    twin_of: str | None = Field(None, description="Pipeline of the extractor that is identical.")
    folded: bool = Field(default=False, description="Whether it is hidden by default.")
    best_of_extractor: bool = Field(description="Whether it is the best of its extractor.")
    studies: list[str] = Field(description="Studies that used it, or the nearest method.")
    unit_rms_deg: list[float | None] | None = Field(description="RMS of all answers by unit.")
    latency_us: float | None = Field(description="Time per sample on `timed_on`, microseconds.")
    time_ratio: float | None = Field(description="The same divided by that of `timed_on.loop`.")
    field_deg: float | None = Field(None, description="Off-axis angle of the rank, if asked for.")
    field_rms_deg: float | None = Field(None, description="Unit 0 RMS within that angle.")
    widest_field_deg: float | None = Field(None, description="Widest field within the limit.")


class LeaderboardDataset(OpenShape):
    """The leaderboard of a data set."""

    name: str
    version: int
    detector: str
    mask: str
    idealisation: str | None = Field(None, description="Reason for an idealised sensor, if any.")
    conditions: list[str]
    smallest_ratio: float | None = Field(None, description="Smallest resolved ratio to the leader.")
    quoted_deg: float | None = Field(None, description="Error on odd units of the leader on even.")
    references: str | None = Field(None, description="Reference readings used for corrections.")
    bench_deg: float | None = Field(None, description="RMS error of the standard bench.")
    bench_aligned_deg: float | None = Field(None, description="The same after alignment.")
    bound_unit_deg: float | None = Field(None, description="RMS bound by reference readings.")
    controls: list[Control] = Field(default_factory=list, description="Two controls.")
    folded: int = Field(0, description="Number of hidden, much less accurate pipelines.")
    rows: list[LeaderboardRow]


class Control(Shape):
    """A control for comparison.

    `oracle` is the truth with the noise of the bound; `boresight` always answers the boresight.
    """

    name: Literal["oracle", "boresight"]
    rms_deg: float | None


class RecordNamed(Shape):
    """Published results that a leaderboard shows."""

    version: str = Field(description="Version of the Atlas; the git tag is `v` plus this.")
    sha256: str | None = Field(description="SHA-256 of checksums-sha256.txt; null if none.")


class Leaderboard(OpenShape):
    """The published leaderboard; empty if none is published."""

    model_config = ConfigDict(extra="allow", serialize_by_alias=True)

    schema_version: int | str | None = Field(alias="schema", description="Its version.")
    datasets: list[LeaderboardDataset]
    timed_on: dict[str, Any] | None = Field(None, description="Machine of the running times.")
    record: RecordNamed = Field(description="Version and digest of the published measurements.")
    total: int = Field(description="Total number of rows.")
    next: str | None = Field(description="Cursor of the next page; null on the last page.")


class ScoresQuery(SortedQuestion, rows=Score):
    """Which scores."""

    model_config = example(limit=1)

    dataset: Several[DatasetName] = several("Only this data set.")
    condition: Several[Condition] = several("Only this condition.")
    extractor: Several[ExtractorName] = several("Only this extractor.")
    model: Several[ModelName] = several("Only this model.")


class LeaderboardQuery(SortedQuestion, rows=LeaderboardRow):
    """Which rows of a data set's leaderboard, and what they are ranked by."""

    model_config = example(limit=1)

    condition: Several[Condition] = several("Only this condition.")
    extractor: Several[ExtractorName] = several("Only this extractor.")
    model: Several[ModelName] = several("Only this model.")
    best_of_extractor: Flag = Field(default=False, description="Only the best of extractors.")
    studied: Flag = Field(default=False, description="Only those that studies used.")
    field_deg: Annotated[str | None, OneOf(lambda: FIELD_EDGES), GIVEN] = Field(
        None,
        description="Rank by the error within this off-axis angle, degrees, weighted by solid "
        "angle.",
    )
    max_error_deg: Annotated[float | None, NUMBER] = Field(
        None,
        gt=0,
        le=180,
        description="Rank by the field of view within which the RMS error is at most this, "
        "degrees.",
    )


Scores = page_of(Score, "Scores", "A page of scores.")
LeaderboardRows = page_of(
    LeaderboardRow,
    "LeaderboardRows",
    "A page of a data set's leaderboard, within a condition the best of each extractor first.",
)
