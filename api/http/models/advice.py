"""What the survey advises, and how the survey and the scores came about."""

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
from api.http.models.words import Detector, Mask

Requirement = Literal["task", "accuracy", "error"]


class AdviceQuery(TableQuestion):
    """Which pieces of advice."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"requirement": ["task"], "mask": ["Slit"], "limit": 1}]}
    )

    requirement: Several[Requirement] = several(
        "Only advice for tasks, accuracy classes or errors."
    )
    detector: Several[Detector] = several("Only advice that names this detector.")
    mask: Several[Mask] = several("Only advice that names this mask.")
    sort: Annotated[str | None, sorting(columns.ADVICE), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.ADVICE)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class Advice(Shape):
    """A piece of advice in the survey's text; empty members are open."""

    id: str
    requirement: Requirement = Field(description="Kind: task, accuracy class or error.")
    value: str = Field(description="Value.")
    detector: str
    mask: str
    model_category: str
    extractor: str = Field(description="An extractor or a family of them.")
    section: str = Field(description="Label in the survey's source.")
    section_name: str = Field(description="Name of the section, with printed number.")
    note: str


class Advices(Listing):
    """A page of advice."""

    items: list[Advice]


class Statement(Shape):
    """A sentence of a protocol."""

    about: Literal["survey", "scores"]
    kind: str
    id: str
    text: str
    section: str = Field(
        description="Label in the survey's source; empty for what is measured here."
    )
    section_name: str = Field(description="Name of the section, with printed number.")


class Protocol(Shape):
    """Selection of studies by the survey, and rules of the scores here."""

    survey: list[Statement]
    scores: list[Statement]
