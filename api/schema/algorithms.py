"""Implementations."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from api.schema.base import Shape, SortedQuestion, example, page_of
from api.schema.parameters import GIVEN

Role = Literal["extractor", "model"]


class Algorithm(Shape):
    """An implementation."""

    name: str
    title: str = Field(description="Display name.")
    role: Role
    taxonomy: str
    category: str | None
    observation: str | None = Field(description="Input of the extractor.")
    kind: str | None = Field(description="Kind of features.")
    accepts: list[str] | None = Field(description="Kinds of features a model reads.")
    labels: list[str] = Field(description="Labels of the survey's source.")
    label_names: list[str] = Field(description="Names of the labels, with printed numbers.")
    studies: list[str]
    origin: str = Field(description="survey: described in the survey; ours: not.")
    version: int
    summary: str = Field(description="One-sentence summary.")


class AlgorithmsQuery(SortedQuestion, rows=Algorithm):
    """Which implementations."""

    model_config = example(role="extractor", limit=1)

    role: Annotated[Role | None, GIVEN] = Field(None, description="Only this role.")


Algorithms = page_of(Algorithm, "Algorithms", "A page of implementations.")
