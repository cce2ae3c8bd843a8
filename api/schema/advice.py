"""What the survey advises, and how the survey and the scores came about."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from api.schema.base import Shape, SortedQuestion, example, page_of
from api.schema.parameters import Several, several
from api.schema.words import Detector, Mask

Requirement = Literal["task", "accuracy", "error"]


class Advice(Shape):
    """A piece of advice in the survey's text; empty members are open."""

    id: str
    requirement: Requirement = Field(description="Kind: task, accuracy class or error.")
    value: str = Field(description="Value.")
    detector: str
    mask: str
    model_category: str = Field(description="Model category named by the advice; empty if open.")
    extractor: str = Field(description="An extractor or a family of them.")
    section: str = Field(description="Label in the survey's source.")
    section_name: str = Field(description="Name of the section, with printed number.")
    note: str


class Statement(Shape):
    """A sentence of a protocol."""

    about: Literal["survey", "scores"] = Field(description="Part of the method it is about.")
    kind: str
    id: str
    text: str
    section: str = Field(description="Label in the survey's source; empty for scores.")
    section_name: str = Field(description="Name of the section, with printed number.")


class Protocol(Shape):
    """Selection of studies by the survey, and rules of the scores here."""

    survey: list[Statement]
    scores: list[Statement]


class AdviceQuery(SortedQuestion, rows=Advice):
    """Which pieces of advice."""

    model_config = example(requirement=["task"], mask=["Slit"], limit=1)

    requirement: Several[Requirement] = several("Only advice for this kind.")
    detector: Several[Detector] = several("Only advice that names this detector.")
    mask: Several[Mask] = several("Only advice that names this mask.")


Advices = page_of(Advice, "Advices", "A page of advice.")
