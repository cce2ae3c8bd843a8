"""Figures of what is claimed, built, simulated and possible: gap, trade-off, robustness."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from api.schema import words
from api.schema.base import DrawnQuestion, OfEdition, Shape, example
from api.schema.comparison import InOrder
from api.schema.parameters import Several, several

Level = Literal["flight", "own", "bound", "reported"]
Across = Literal["field", "height", "poses", "latency", "power", "mass"]
Named = Annotated[str, Field(min_length=1, max_length=200)]
OF_PRODUCTS = ("power", "mass")
"""What only built sensors state."""


class MeasuredFigure(Shape):
    """A figure of measurements with its sentences."""

    figure: str
    title: str
    caption: str = Field(description="What the figure shows.")
    text: list[str] = Field(description="What is seen, in sentences.")
    options: dict[str, str] = Field(description="Settings of the figure.")


class GapQuery(OfEdition, DrawnQuestion):
    """Which architectures, in which order."""

    model_config = example(detector=["CMOS"], level="own")

    level: Level = Field(
        "flight",
        description="Error that rows are ordered by. own also chooses the pipeline by own error.",
    )
    detector: Several[words.Detector] = several("Only this detector.")
    mask: Several[words.Mask] = several("Only this mask.")
    task: Several[words.Task] = several("Only studies with this task.")
    error: Several[words.Error] = several("Only studies that treat this source of error.")


class GapRow(Shape):
    """An architecture: what is reported of it, and its most accurate pipeline.

    Numbers are null where undefined. Intervals are two standard errors over sensor units.
    """

    detector: str
    mask: str
    flight_error_deg: float | None = Field(description="Error in flight, mean over sensor units.")
    flight_low_deg: float | None = Field(description="Lower end of its interval.")
    flight_high_deg: float | None = Field(description="Upper end of its interval.")
    own_error_deg: float | None = Field(description="Own error: geometric mean over sensor units.")
    own_low_deg: float | None = Field(description="Lower end of its interval.")
    own_high_deg: float | None = Field(description="Upper end of its interval.")
    bound_deg: float | None = Field(description="Cramer-Rao bound for a known unit.")
    dataset: str | None = Field(description="Data set of the pipeline.")
    extractor: str | None
    model: str | None
    studies: list[str] = Field(description="Studies that report an accuracy.")
    study_rms_deg: list[float] = Field(description="Their accuracies as RMS, in the same order.")
    products: list[str] = Field(description="Built sensors that state an accuracy.")
    product_rms_deg: list[float] = Field(description="Their accuracies as RMS, in the same order.")
    page: str = Field(description="Address of the architecture's page.")


class Gap(MeasuredFigure):
    """Reported accuracy, error in flight, own error and bound of every architecture."""

    items: list[GapRow]


class TradeOffQuery(DrawnQuestion):
    """Which pipelines, and error against what."""

    model_config = example(across="latency", level="own", dataset=["qpd-single-aperture"])

    across: Across = Field(
        "field",
        description="What the error is set against: full field of view, height of the mask, "
        "calibration poses, time per reading; power or mass as built sensors state them.",
    )
    level: Literal["flight", "own", "reported"] | None = Field(
        None,
        description="Which error. Default flight; reported for power and mass, which no pipeline "
        "has.",
    )
    detector: Several[words.Detector] = several("Only this detector.")
    mask: Several[words.Mask] = several("Only this mask.")
    dataset: Several[words.DatasetName] = several("Only this data set.")
    extractor: Several[words.ExtractorName] = several("Only this extractor.")
    model: Several[words.ModelName] = several("Only this model.")
    select: Several[Named] = several("Names of rows to mark, as `name` gives them.")


class TradeOffRow(Shape):
    """A pipeline on a data set, or a report of a study or a built sensor."""

    name: str = Field(description="dataset:extractor:model; key of a study, or name of a sensor.")
    status: Literal["frontier", "not separable", "dominated", "untested"] = Field(
        description="frontier: none has a smaller error at no higher cost. Others by the paired "
        "test over units against the frontier; untested: fewer than five units in common with it."
    )
    selected: bool = Field(description="Whether it was named by `select`.")
    detector: str
    mask: str
    dataset: str | None
    extractor: str | None
    model: str | None
    error_deg: float = Field(description="Error at the level asked for.")
    low_deg: float | None = Field(description="Smallest error of a unit; null with one unit.")
    high_deg: float | None = Field(description="Largest error of a unit.")
    bound_deg: float | None
    field_deg: float | None = Field(description="Full field of view; 360 for all directions.")
    height_mm: float | None = Field(description="Height of mask or lens; null if there is none.")
    poses: int | None = Field(description="Poses to be within 10 % of the error floor.")
    latency_us: float | None = Field(description="Time per reading on `timed_on`.")
    power_mw: float | None = Field(description="Power from the spacecraft; 0 if self-powered.")
    mass_g: float | None = Field(description="Stated mass.")


class TradeOff(MeasuredFigure):
    """Error against a cost, with the frontier."""

    timed_on: str | None = Field(description="Processor of the running times.")
    left_out: int = Field(description="Rows without the quantity asked for.")
    folded: int = Field(description="Rows far behind on their board, not listed.")
    items: list[TradeOffRow]


class RobustnessQuery(DrawnQuestion):
    """Which rows, which conditions, which two against each other."""

    model_config = example(condition=["albedo", "hot"], compare=["mirror", "bctm"])

    rows: Literal["extractor", "model"] = Field("extractor", description="What a row is.")
    condition: Several[words.Condition] = several(
        "Condition to tolerate. Several: the worst of them, on data sets that have all."
    )
    hazard: Several[words.Hazard] = several(
        "Hazard to tolerate: all conditions of a data set that try it."
    )
    detector: Several[words.Detector] = several("Only data sets with this detector.")
    mask: Several[words.Mask] = several("Only data sets with this mask.")
    compare: InOrder[Named] = Field(
        default_factory=list, description="Two names of rows to compare on every board."
    )


class RobustnessRow(Shape):
    """An extractor or model under a condition, pooled over data sets."""

    name: str = Field(description="Extractor or model.")
    condition: str = Field(description="Condition; `worst` for the worst of those asked for.")
    state: Literal["measured", "below 95 %", "untested"] = Field(
        description="below 95 %: on half of the data sets or more the availability is too low."
    )
    over_bound: float | None = Field(description="Median multiple of the bound over data sets.")
    over_best: float | None = Field(
        description="Median of the same over that of the best row on the same data set."
    )
    data_sets: int = Field(description="Number of data sets behind it.")
    answered: int = Field(description="Of these, with 95 % availability.")
    datasets: list[str] = Field(description="Those data sets.")


class BestRow(Shape):
    """The best extractor or model of a data set under the worst of what is asked for."""

    dataset: str
    name: str = Field(description="Extractor or model.")
    over_bound: float


class PairwiseRow(Shape):
    """Two rows against each other on the data sets and conditions that have both."""

    scope: Literal["all conditions", "first condition"] = Field(description="Boards counted.")
    first: str = Field(description="Row whose wins are counted.")
    second: str = Field(description="The other row.")
    wins: int = Field(description="Boards on which the first has the smaller error.")
    ties: int = Field(description="Boards on which the errors differ by at most 3 %.")
    losses: int = Field(description="Boards on which the first has the larger error.")
    neither: int = Field(description="Boards on which both are below 95 % availability.")
    data_sets: int = Field(description="Number of data sets.")
    share_low: float | None = Field(
        description="95 % interval of the share of wins without ties (Clopper-Pearson), as if "
        "boards were independent."
    )
    share_high: float | None = Field(description="Its upper end.")
    ratio: float | None = Field(description="Median error of the first over the second.")
    ratio_low: float | None = Field(
        description="95 % interval of that median by a bootstrap over data sets."
    )
    ratio_high: float | None = Field(description="Its upper end; null if unbounded.")


class DuelRow(Shape):
    """Two rows on one board."""

    dataset: str
    condition: str
    first_over_bound: float | None = Field(description="Null below 95 % availability.")
    second_over_bound: float | None = Field(description="Null below 95 % availability.")
    ratio: float | None = Field(description="First over second; null where one does not answer.")
    outcome: Literal["win", "tie", "loss", "neither"] = Field(description="For the first.")


class Robustness(MeasuredFigure):
    """Multiples of the bound by condition."""

    best: list[BestRow] = Field(
        description="Row with the least worst multiple on each data set that has all asked for."
    )
    together: list[str] = Field(
        description="Conditions of the record in which all that is asked acts at once."
    )
    items: list[RobustnessRow]
    pairwise: list[PairwiseRow] = Field(description="Wins of the first of two; empty if not asked.")
    duels: list[DuelRow] = Field(description="The two on every board that has both.")
