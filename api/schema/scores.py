"""Scores and leaderboards."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from api.schema.base import Listing, OpenShape, Shape, SortedQuestion, TableQuestion
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

    model_config = ConfigDict(json_schema_extra={"examples": [{"limit": 1}]})

    whole: Flag = Field(
        default=False, description="Return all rows at once (more than 10 MB of JSON)."
    )
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class Place(OpenShape):
    """A pipeline on a data set in a condition."""

    dataset: str
    condition: str
    extractor: str
    model: str


class Outcome(OpenShape):
    """Whether there is a score."""

    status: Literal["ok", "refused", "failed"]
    reason: str = Field(description="Reason for a missing score; empty otherwise.")


class Accuracy(OpenShape):
    """Errors over the observable samples with an answer, and the bounds over the same."""

    rms_deg: float | None = Field(
        description=(
            "RMS error over the observable samples with an answer, calibrated with true "
            "directions; under `on-bench` with directions of random benches."
        )
    )
    charged_deg: float | None = Field(
        description=(
            "RMS error over all answers, including those to unobservable samples. Ranks use it."
        )
    )
    aligned_deg: float | None = Field(description="RMS error after boresight alignment.")
    bound_deg: float | None = Field(description="RMS Cramer-Rao bound for a known sensor unit.")
    bound_unit_deg: float | None = Field(
        description=(
            "RMS Cramer-Rao bound for a unit known only through its dark and flat frames; "
            "null if elements do not differ individually."
        )
    )


class AnswerRates(OpenShape):
    """How often there is an answer."""

    availability: float | None = Field(
        description="Availability: share of observable samples with an answer."
    )
    false_sun: float | None = Field(
        description=(
            "False detections: share of unobservable samples with an answer; null without "
            "such samples."
        )
    )


class Subject(OpenShape):
    """Versions of what was measured, and its values of the taxonomy."""

    dataset_version: int = Field(description="Version of the data set.")
    unit: int = Field(description="Sensor unit; 0 is the standard unit.")
    detector: str
    mask: str
    half_fov_deg: float | None
    extractor_taxonomy: str
    extractor_version: int
    model_taxonomy: str
    model_version: int = Field(description="Version of the model.")


class Statistics(OpenShape):
    """Numbers of samples, and further statistics of the error."""

    n_calibration: int | None = Field(description="Number of samples in the calibration split.")
    n_test: int | None = Field(description="Number of samples in the test split.")
    n_observable: int | None = Field(description="Number of observable test samples.")
    median_deg: float | None = Field(description="Median separation angle, degrees.")
    p95_deg: float | None = Field(description="95th percentile of the separation angle, degrees.")
    p997_deg: float | None = Field(
        description="99.7th percentile of the separation angle, degrees."
    )
    max_deg: float | None = Field(description="Largest separation angle, degrees.")
    bias_alpha_deg: float | None = Field(description="Mean error of alpha, degrees.")
    bias_beta_deg: float | None = Field(description="Mean error of beta, degrees.")
    rms_alpha_deg: float | None = Field(description="Root mean square error of alpha, degrees.")
    rms_beta_deg: float | None = Field(description="Root mean square error of beta, degrees.")
    repeatability_deg: float | None = Field(
        description=(
            "Repeatability: standard deviation of answers at a fixed pose, over both axes."
        )
    )
    over_bound: float | None = Field(description="RMS error divided by the bound.")
    over_bound_se: float | None = Field(description="Standard error of that ratio.")
    over_bound_unit: float | None = Field(description="RMS error divided by that bound.")


class RingErrors(OpenShape):
    """Errors by off-axis angle (`benchmark.metrics.rings`)."""

    rms_0_10_deg: float | None = None
    rms_10_20_deg: float | None = None
    rms_20_30_deg: float | None = None
    rms_30_40_deg: float | None = None
    rms_40_50_deg: float | None = None
    rms_50_60_deg: float | None = None
    rms_60_70_deg: float | None = None
    rms_70_90_deg: float | None = None
    rms_90_180_deg: float | None = None


class MetricVersion(OpenShape):
    """Version of the metrics."""

    metric_version: int | None = Field(None, description="Version of the metrics.")


# Members of a class stand behind those of the classes named after it.
class Score(MetricVersion, RingErrors, Statistics, Subject, AnswerRates, Accuracy, Outcome, Place):
    """What a pipeline achieves on a data set in a condition. Numbers are null where undefined.

    Errors, the bound and their ratio are over the same samples: observable and answered.
    """


class Scores(Listing):
    """A page of scores."""

    items: list[Score]


class Rank(OpenShape):
    """Rank in a data set and condition."""

    rank: int | None = Field(
        description=(
            "Rank by own error, or by the error over the requested field. Pipelines below "
            "95 % availability rank last; null without an error."
        )
    )
    group: int | None = Field(
        None,
        description=(
            "1 for pipelines that a paired test over units cannot separate from the "
            "leader, 2 for the next such group, and so on; null with fewer than five "
            "units."
        ),
    )
    tied: bool = Field(description="Whether the rank is shared.")


class OwnAccuracy(OpenShape):
    """Own error over the sensor units, and what a calibration bench makes of it."""

    own_deg: float | None = Field(
        None, description="Own error: geometric mean of `charged_deg` over units."
    )
    own_se: float | None = Field(
        None, description="Relative standard error of the own error over units."
    )
    on_bench_deg: float | None = Field(
        None, description="Error expected with the standard calibration bench."
    )
    on_bench_basis: Literal["measured", "estimated"] | None = Field(
        None,
        description=(
            "measured on twenty random benches, or estimated as the root sum of squares "
            "of own error and bench error."
        ),
    )


class Spread(OpenShape):
    """Spread over the sensor units, and whether a row is hidden."""

    low_deg: float | None = Field(description="Smallest error over units; null with one unit.")
    high_deg: float | None = Field(description="Largest error over units.")
    twin_of: str | None = Field(
        None, description="Pipeline of the same extractor with identical results."
    )
    folded: bool = Field(
        default=False, description="Whether it is hidden by default, as much less accurate."
    )


class OfExtractor(OpenShape):
    """Whether it is the best of its extractor, and who used it."""

    best_of_extractor: bool = Field(
        description="Whether it is the best pipeline of its extractor. These are listed first."
    )
    studies: list[str] = Field(
        description="Studies that used this pipeline, or the nearest method, on such a sensor."
    )


class Units(OpenShape):
    """Errors of the sensor units, and times."""

    unit_rms_deg: list[float | None] | None = Field(
        description="RMS error of all answers on each sensor unit, standard unit first."
    )
    latency_us: float | None = Field(
        description=(
            "Time of extraction and prediction of one sample of a batch on the machine of "
            "`timed_on`, microseconds; null if not timed or not runnable."
        )
    )
    time_ratio: float | None = Field(description="The same divided by that of `timed_on.loop`.")
    field_deg: float | None = Field(
        None, description="Off-axis angle that the rank is for; null if not asked for."
    )
    field_rms_deg: float | None = Field(
        None, description="RMS error within that angle; null if not asked for."
    )
    widest_field_deg: float | None = Field(
        None, description="Widest field within the maximum error; null if not asked for."
    )


class LeaderboardRow(
    Units,
    MetricVersion,
    RingErrors,
    Statistics,
    Outcome,
    Subject,
    OfExtractor,
    AnswerRates,
    Spread,
    Accuracy,
    OwnAccuracy,
    Place,
    Rank,
):
    """A score with its rank."""


class LeaderboardDataset(OpenShape):
    """The leaderboard of a data set."""

    name: str
    version: int
    detector: str
    mask: str
    idealisation: str | None = Field(
        None, description="Reason for an idealised sensor; null if built sensors exist."
    )
    conditions: list[str]
    smallest_ratio: float | None = Field(
        None,
        description="Smallest error ratio to the leader that is resolved in nine of ten cases.",
    )
    quoted_deg: float | None = Field(
        None, description="Error on odd units of the pipeline that leads on even units."
    )
    references: str | None = Field(None, description="Reference readings used for corrections.")
    bench_deg: float | None = Field(
        None, description="RMS error of the standard calibration bench."
    )
    bench_aligned_deg: float | None = Field(
        None, description="RMS bench error after boresight alignment."
    )
    bound_unit_deg: float | None = Field(
        None, description="RMS bound for a unit known only through its reference readings."
    )
    controls: list[Control] = Field(
        default_factory=list, description="Two controls for comparison."
    )
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
    sha256: str | None = Field(
        description=(
            "SHA-256 of manifest.json, which lists every file of the published results; "
            "null if none."
        )
    )


class TimedOn(Shape):
    """The machine on which running times were measured."""

    processor: str = Field(description="Model of the processor.")
    cores: int = Field(description="Number of cores used.")
    python: str = Field(description="Version of Python.")
    numpy: str = Field(description="Version of NumPy.")
    date: str = Field(description="Date of the first measurement.")
    loop: str = Field(description="The reference loop that times are multiples of.")
    loop_us: float = Field(description="Its time, microseconds.")
    also_on: list[str] = Field(description="Processors on which some pipelines were timed instead.")


class Leaderboard(OpenShape):
    """The published leaderboard; empty if none is published."""

    model_config = ConfigDict(extra="allow", serialize_by_alias=True)

    schema_version: int | str | None = Field(
        alias="schema", description="Version of the document's structure."
    )
    datasets: list[LeaderboardDataset]
    timed_on: TimedOn | None = Field(None, description="Machine of the times; null for none.")
    record: RecordNamed = Field(description="Version and digest of the published measurements.")
    total: int = Field(description="Total number of rows.")
    next: str | None = Field(description="Cursor of the next page; null on the last page.")


class LeaderboardRows(Listing):
    """A page of a data set's leaderboard, within a condition the best of each extractor first."""

    items: list[LeaderboardRow]


class ScoresQuery(SortedQuestion, rows=Score):
    """Which scores."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"limit": 1}]})

    dataset: Several[DatasetName] = several("Only this data set.")
    condition: Several[Condition] = several("Only this condition.")
    extractor: Several[ExtractorName] = several("Only this extractor.")
    model: Several[ModelName] = several("Only this model.")


class LeaderboardQuery(SortedQuestion, rows=LeaderboardRow):
    """Which rows of a data set's leaderboard, and what they are ranked by."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"limit": 1}]})

    condition: Several[Condition] = several("Only this condition.")
    extractor: Several[ExtractorName] = several("Only this extractor.")
    model: Several[ModelName] = several("Only this model.")
    best_of_extractor: Flag = Field(
        default=False,
        description="Only the best pipeline of each extractor.",
    )
    studied: Flag = Field(
        default=False,
        description="Only pipelines that studies used on such a sensor.",
    )
    field_deg: Annotated[str | None, OneOf(lambda: FIELD_EDGES), GIVEN] = Field(
        None,
        description=(
            "Rank by the error within this off-axis angle, degrees, weighted by solid angle."
        ),
    )
    max_error_deg: Annotated[float | None, NUMBER] = Field(
        None,
        gt=0,
        le=180,
        description=(
            "Rank by the field of view within which the RMS error is at most this, degrees."
        ),
    )
