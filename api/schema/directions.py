"""The survey's future directions, each with a rule and a verdict."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from api.schema.base import Shape

Verdict = Literal["pays", "does not pay", "depends on the data set", "open", "not tried"]


class DirectionDuel(Shape):
    """Two families of methods on one data set."""

    dataset: str = Field(description="Data set.")
    first: str = Field(description="Best pipeline of the first family, by the even units.")
    second: str = Field(description="Best pipeline of the second family, by the even units.")
    ratio: float = Field(description="Error of the first over the second, on the odd units.")
    outcome: Literal["win", "loss", "tie"] = Field(description="For the first family.")


class DirectionRow(Shape):
    """A future direction of the survey with its verdict: a row of the table."""

    id: str
    general: str = Field(description="Category in the survey's table.")
    specific: str = Field(description="Part of the category.")
    future_directions: str = Field(description="What the survey suggests.")
    question: str = Field(description="What is asked here.")
    kind: Literal["duel", "paper", "trial", "untried"] = Field(
        description="Decided by families of methods in the record, a calculation or an experiment."
    )
    verdict: Verdict = Field(description="By the rule; open: told apart on too few data sets.")
    text: str = Field(description="What decides, in a sentence.")
    rule: str = Field(description="What decides, as it was written down before; empty if untried.")
    value: float | None = Field(description="The number that decides.")
    against: float | None = Field(description="What it is compared with.")
    unit: str = Field(description="Of both.")


class Direction(DirectionRow):
    """A direction with what each data set says."""

    duels: list[DirectionDuel] = Field(description="Families on data sets; empty otherwise.")


class Directions(Shape):
    """The survey's twelve future directions."""

    words: str = Field(description="Directions by verdict.")
    items: list[Direction]
