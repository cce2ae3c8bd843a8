"""Scores and leaderboards."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from api import columns
from api.http.models.base import Listing, OpenShape, Shape, TableQuestion
from api.http.models.parameters import (
    DEFAULT_PAGE,
    FIELDS,
    GIVEN,
    NUMBER,
    SORT,
    Cursor,
    Flag,
    Limit,
    OneOf,
    Several,
    columns_of,
    several,
    sorting,
)
from api.http.models.words import Condition, DatasetName, ExtractorName, ModelName
from benchmark.metrics.rings import EDGES_DEG

FIELD_EDGES = tuple(str(edge) for edge in EDGES_DEG[1:])


class ScoresQuery(TableQuestion):
    """Which scores."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"limit": 1}]})

    dataset: Several[DatasetName] = several("Only this data set.")
    condition: Several[Condition] = several("Only this condition.")
    extractor: Several[ExtractorName] = several(
        "Only this extractor, by the name of its implementation."
    )
    model: Several[ModelName] = several("Only this model, by the name of its implementation.")
    sort: Annotated[str | None, sorting(columns.RESULTS), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.RESULTS)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class WholeLeaderboardQuery(TableQuestion):
    """Which part of the leaderboard of all data sets."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"limit": 1}]})

    whole: Flag = Field(
        default=False, description="All rows in one answer, which has more than 10 MB as JSON."
    )
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class LeaderboardQuery(TableQuestion):
    """Which rows of a data set's leaderboard, and what they are ranked by."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"limit": 1}]})

    condition: Several[Condition] = several("Only this condition.")
    extractor: Several[ExtractorName] = several(
        "Only this extractor, by the name of its implementation."
    )
    model: Several[ModelName] = several("Only this model, by the name of its implementation.")
    best_of_extractor: Flag = Field(
        default=False,
        description="Only the pipeline of each extractor that ranks before its others.",
    )
    studied: Flag = Field(
        default=False,
        description="Only pipelines that mapped studies used on such a sensor.",
    )
    field_deg: Annotated[str | None, OneOf(lambda: FIELD_EDGES), GIVEN] = Field(
        None,
        description="Rank by the error within this angle of the boresight, degrees: rings of the "
        "field count by their solid angle, so that sensors compare at an equal field.",
    )
    max_error_deg: Annotated[float | None, NUMBER] = Field(
        None,
        gt=0,
        le=180,
        description="Rank by the widest field in whose every ring the RMS error stays within "
        "this, degrees.",
    )
    sort: Annotated[str | None, sorting(columns.LEADERBOARD), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.LEADERBOARD)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class Score(OpenShape):
    """What a pipeline achieves on a data set in a condition. Numbers are null where undefined.

    Errors, the bound and their ratio are over the same samples: observable and answered.
    """

    dataset: str
    dataset_version: int
    condition: str
    unit: int = Field(description="Which unit of the sensor; 0 is the standard one.")
    detector: str
    mask: str
    half_fov_deg: float | None
    extractor: str
    extractor_taxonomy: str
    extractor_version: int
    model: str
    model_taxonomy: str
    model_version: int
    status: Literal["ok", "refused", "failed"]
    reason: str = Field(description="Why there is no score; empty where there is one.")
    n_calibration: int | None
    n_test: int | None
    n_observable: int | None = Field(description="Test samples whose direction is observable.")
    availability: float | None = Field(description="Answered share of the observable samples.")
    false_sun: float | None = Field(
        description="Answered share of the samples that are not observable; null without any."
    )
    rms_deg: float | None = Field(
        description="Root mean square error, calibrated with true directions; under `on-bench` "
        "with those that drawn benches give."
    )
    charged_deg: float | None = Field(
        description="The same over all answers, those to samples whose direction is not observable "
        "among them. Ranks are by it."
    )
    aligned_deg: float | None = Field(
        description="Root mean square error that is left after the best rotation of all answers."
    )
    median_deg: float | None
    p95_deg: float | None
    p997_deg: float | None
    max_deg: float | None
    bias_alpha_deg: float | None
    bias_beta_deg: float | None
    rms_alpha_deg: float | None
    rms_beta_deg: float | None
    repeatability_deg: float | None = Field(
        description="Standard deviation of answers to a pose held still, over both axes."
    )
    bound_deg: float | None = Field(description="Cramer-Rao bound, rms, with the unit known.")
    over_bound: float | None = Field(description="RMS error over the bound.")
    over_bound_se: float | None = Field(description="Standard error of that ratio.")
    bound_unit_deg: float | None = Field(
        description="Cramer-Rao bound, rms, with the unit unknown but for flat and dark readings; "
        "null where elements do not differ each by itself."
    )
    over_bound_unit: float | None = Field(description="RMS error over that bound.")


class Scores(Listing):
    """A page of scores."""

    items: list[Score]


class LeaderboardRow(Score):
    """A score with its place. Members `rms_<inner>_<outer>_deg` are errors by off-axis angle."""

    rank: int | None = Field(
        description="Place in the condition by own error, or by the error over the field asked "
        "for. Pipelines that answer less than 95 % come behind all others; null without an error."
    )
    group: int | None = Field(
        None,
        description="1 for what a paired test over units does not tell apart from the leader, 2 "
        "for what it does not tell apart from the best of the others, and so on; null where the "
        "pipeline was scored on fewer than five units.",
    )
    tied: bool = Field(description="Whether others share the rank.")
    own_deg: float | None = Field(
        None, description="Own error: geometric mean over units of `charged_deg`."
    )
    own_se: float | None = Field(None, description="Its relative standard error over units.")
    on_bench_deg: float | None = Field(
        None, description="Error expected when calibrated on the standard bench."
    )
    on_bench_basis: Literal["measured", "estimated"] | None = Field(
        None,
        description="Measured on twenty drawn benches, or estimated: root of the squares of own "
        "error and bench.",
    )
    twin_of: str | None = Field(
        None, description="A pipeline of the same extractor with the same numbers throughout."
    )
    folded: bool = Field(
        default=False, description="Whether it is so far behind that boards show it only if asked."
    )
    best_of_extractor: bool = Field(
        description="Whether no other pipeline of its extractor ranks before it. These are listed "
        "first, the others behind."
    )
    studies: list[str] = Field(
        description="Mapped studies that used this pipeline on such a sensor, or for which it "
        "stands in."
    )
    unit_rms_deg: list[float | None] | None = Field(
        description="Error over all answers on each unit of the sensor, the standard one first."
    )
    low_deg: float | None = Field(
        description="Smallest error of a unit; null where one unit is scored."
    )
    high_deg: float | None = Field(description="Largest error of a unit.")
    latency_us: float | None = Field(
        description="Extraction and prediction of one sample on this machine, microseconds; null "
        "where it is not timed."
    )
    time_ratio: float | None = Field(description="The same over the time of a reference.")


class LeaderboardDataset(OpenShape):
    """The leaderboard of a data set."""

    name: str
    version: int
    detector: str
    mask: str
    idealisation: str | None = Field(
        None, description="Why it stands for no built sensor; null where it stands for one."
    )
    conditions: list[str]
    smallest_ratio: float | None = Field(
        None, description="Ratio to the leader that the board tells apart in nine of ten cases."
    )
    quoted_deg: float | None = Field(
        None, description="Error on the odd units of the pipeline that leads on the even ones."
    )
    references: str | None = Field(None, description="References that readings are corrected by.")
    bench_deg: float | None = Field(
        None, description="Fixed error of the standard calibration bench, root mean square."
    )
    bench_aligned_deg: float | None = Field(
        None, description="What the best rotation leaves of it."
    )
    bound_unit_deg: float | None = Field(
        None, description="Bound with the unit known by its references, root mean square."
    )
    controls: list[Control] = Field(default_factory=list, description="Two answers to compare to.")
    folded: int = Field(0, description="Pipelines that are far behind.")
    rows: list[LeaderboardRow]


class Control(Shape):
    """An answer that no method gives: `oracle` has the bound's noise, `boresight` never moves."""

    name: Literal["oracle", "boresight"]
    rms_deg: float | None


class RecordNamed(Shape):
    """Which record a leaderboard shows."""

    version: str = Field(description="Of the atlas; its tag is `v` and this.")
    sha256: str | None = Field(
        description="Of manifest.json of the record, which names every file of it by its digest; "
        "null where there is none."
    )


class Leaderboard(OpenShape):
    """The published leaderboard; no schema and no data sets where none is published."""

    model_config = ConfigDict(extra="allow", serialize_by_alias=True)

    schema_version: int | str | None = Field(alias="schema")
    datasets: list[LeaderboardDataset]
    record: RecordNamed
    total: int = Field(description="Rows of all data sets together.")
    next: str | None = Field(description="Cursor of the next page; null on the last.")


class LeaderboardRows(Listing):
    """A page of a data set's leaderboard, within a condition the best of each extractor first."""

    items: list[LeaderboardRow]
