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


class SpoofedSensor(Shape):
    """A sensor and pipeline under a laser as bright as the Sun beside it."""

    dataset: str = Field(description="Data set.")
    extractor: str
    model: str
    has_pattern: bool = Field(description="Whether its mask casts a pattern: it decides.")
    own_error_deg: float = Field(description="RMS error of clean readings, degrees.")
    readings: int = Field(description="Readings with the laser.")
    deceived: float = Field(description="Share off by more than ten own errors without a flag.")
    pull_deg: float | None = Field(description="Median error of these, degrees.")
    noticed: float | None = Field(description="Share of wrong or no answers that is noticed.")
    noticed_low: float = Field(description="Lower end of its 95 % interval.")
    noticed_high: float = Field(description="Upper end.")
    either: float | None = Field(description="Share that residual or brightness notices.")
    agreement: float | None = Field(description="Share that a cube of photodiodes beside it does.")
    knowable: float | None = Field(description="Share that the best test of a known unit notices.")
    clean: int = Field(description="Clean readings that check the threshold.")
    false_alarms: int = Field(description="How many of them alarm.")
    keeps_rate: bool = Field(description="Whether this agrees with one in 10,000 (5 %).")


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
    sensors: list[SpoofedSensor] = Field(description="Sensors under a laser; empty otherwise.")
    experiment: str = Field(description="Experiment with plots and more numbers; may be empty.")


class Directions(Shape):
    """The survey's twelve future directions."""

    words: str = Field(description="Directions by verdict.")
    items: list[Direction]
