"""Implementations."""

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
    sorting,
)

Role = Literal["extractor", "model"]


class AlgorithmsQuery(TableQuestion):
    """Which implementations."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"role": "extractor", "limit": 1}]})

    role: Annotated[Role | None, GIVEN] = Field(
        None, description="Only implementations with this role."
    )
    sort: Annotated[str | None, sorting(columns.ALGORITHMS), GIVEN] = SORT
    fields: Several[Annotated[str, columns_of(columns.ALGORITHMS)]] = FIELDS
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class Algorithm(Shape):
    """An implementation."""

    name: str
    role: Role
    taxonomy: str
    category: str | None
    observation: str | None = Field(description="Input of the extractor.")
    kind: str | None = Field(description="Kind of features.")
    accepts: list[str] | None = Field(description="Kinds of features a model reads.")
    labels: list[str] = Field(description="Labels of the survey's source.")
    label_names: list[str] = Field(description="Names of the labels, with printed numbers.")
    studies: list[str]
    origin: str
    version: int
    summary: str


class Algorithms(Listing):
    """A page of implementations."""

    items: list[Algorithm]
