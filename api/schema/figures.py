"""Figures of the survey."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field

from api.schema.base import Shape
from api.schema.figure_rows import COLUMNS, ROWS
from api.schema.flows import LeftOut
from api.schema.parameters import OneOf
from api.schema.studies import StudyFilters
from registry.taxonomy import LEVELS

Level = Annotated[str, OneOf(lambda: LEVELS)]


class FigureQuery(StudyFilters):
    """Of which studies."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"detector": ["Event"]}]})


class MatrixQuery(StudyFilters):
    """Of which studies, by which two attributes or what their values imply."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"rows": "detector", "columns": "mask", "detector": ["PSD"], "mask": ["Lens"]}
            ]
        }
    )

    rows: Level = Field(ROWS, description="Attribute of the rows.")
    columns: Level = Field(
        COLUMNS,
        description=(
            "Attribute of the columns; the same attribute as the rows shows which values "
            "occur together."
        ),
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
