"""Figures of the survey."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from api.schema.base import DrawnQuestion, Shape, example
from api.schema.flows import LeftOut
from api.schema.parameters import OneOf
from api.schema.studies import StudyFilters
from registry.taxonomy import LEVELS

Level = Annotated[str, OneOf(lambda: LEVELS)]
ROWS, COLUMNS = "detector", "mask"
"""Attributes of the evidence map where none are asked for."""


class FigureQuery(DrawnQuestion, StudyFilters):
    """Of which studies."""

    model_config = example(detector=["Event"])


class MatrixQuery(DrawnQuestion, StudyFilters):
    """Of which studies, by which two attributes or what their values imply."""

    model_config = example(rows="detector", columns="mask", detector=["PSD"], mask=["Lens"])

    rows: Level = Field(ROWS, description="Attribute of the rows.")
    columns: Level = Field(
        COLUMNS,
        description="Attribute of the columns; the same attribute as the rows shows which values "
        "occur together.",
    )


class ListedFigure(Shape):
    """A figure of the survey."""

    figure: str
    title: str
    caption: str
    levels: list[str] = Field(description="Attributes shown.")


class Figures(Shape):
    """The survey's figures."""

    items: list[ListedFigure]
    studies: int = Field(description="Number of studies in the figures.")


class Figure(Shape):
    """A figure with its description and table."""

    figure: str
    title: str
    caption: str
    text: list[str]
    studies: int = Field(description="Number of studies that match the filters.")
    options: dict[str, str] = Field(description="Settings of the figure.")
    counts: dict[str, int] = Field(description="Number of pairs in each state (evidence map).")
    left_out: list[LeftOut]
    columns: list[str] = Field(description="Columns of the table.")
    rows: list[dict[str, str | int | float | list[str] | None]]


class FlowRow(Shape):
    """A value of a flow figure, or a pair of neighbouring values."""

    level: str
    value: str
    name: str = Field(description="Name of the value.")
    next_level: str = Field(description="Attribute to the right; empty for a value by itself.")
    next_value: str = Field(description="Value to the right.")
    next_name: str = Field(description="Name of the value to the right.")
    count: int = Field(description="Number of studies.")
    studies: list[str]


class ArcRow(Shape):
    """An arc of the sunburst of models."""

    level: str
    model_category: str = Field(description="Category of models.")
    calibration: str = Field(description="Kind of calibration.")
    model: str = Field(description="Model of the taxonomy.")
    name: str = Field(description="Name of the arc.")
    count: int = Field(description="Number of studies.")
    memberships: int = Field(description="Number of pairs of a study and a model.")
    studies: list[str]


class PublicationRow(Shape):
    """A part of the bar of a year or venue."""

    part: str = Field(description="year or venue.")
    value: str = Field(description="The year or venue.")
    stack: str = Field(description="Part of the bar.")
    count: int = Field(description="Number of studies.")
    studies: list[str]


class SensorRow(Shape):
    """A sensor of a study: a line in parallel coordinates."""

    study: str
    year: int | None
    detector: str
    mask: str
    fov_deg: float | None = Field(description="Published field of view, degrees.")
    accuracy_rms_deg: float | None = Field(description="Published accuracy converted to RMS.")
    accuracy_deg: float | None = Field(description="Published accuracy.")
    accuracy_kind: str
    precision_deg: float | None
    precision_kind: str = Field(description="Statistic of the published precision.")
    accuracy: str = Field(description="Accuracy class.")
    studies: list[str]


class PairRow(Shape):
    """A pair of values in the evidence map."""

    row_level: str = Field(description="Attribute of the rows.")
    row: str = Field(description="Value of the row.")
    row_name: str = Field(description="Name of that value.")
    column_level: str = Field(description="Attribute of the columns.")
    column: str = Field(description="Value of the column.")
    column_name: str = Field(description="Name of that value.")
    state: str = Field(description="measured, studied, impossible, unknown or unstudied.")
    count: int = Field(description="Number of studies with both.")
    studies: list[str]
    reason: str = Field(description="Reason why the pair is impossible.")
    unknown: list[str] = Field(description="Studies of which one value is unknown.")
    pipelines: int = Field(description="Number of measured pipelines.")
    best_own_error_deg: float | None = Field(description="Lowest own error measured.")
    best_dataset: str = Field(description="Data set of the pipeline with that error.")
    best_extractor: str = Field(description="Its extractor.")
    best_model: str = Field(description="Its model.")
    command: str = Field(description="Command that measures the pair.")
    leads_to: str = Field(description="Address of the requirement or board.")
