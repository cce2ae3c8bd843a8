"""The vocabulary, and decision flows."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from api.schema.base import Shape, example
from api.schema.parameters import Flag
from api.schema.studies import StudyFilters


class FlowsQuery(StudyFilters):
    """Which studies flow, and how they are counted."""

    model_config = example(error=["Electrical"], detector=["CMOS"])

    counting: Literal["studies", "fractional"] = Field(
        "studies",
        description="studies: number of distinct studies per link. fractional: each study has "
        "weight one, divided over the combinations of its values, so that inflow equals outflow.",
    )
    grouped: Flag = Field(False, description="Show categories and families.")


class Node(Shape):
    """A value at a level of a decision flow."""

    id: str
    level: str
    value: str
    name: str
    count: float = Field(description="Number of studies, or sum of their fractions.")
    studies: list[str]


class Link(Shape):
    """Link between two values with its studies."""

    source: str
    target: str = Field(description="Target node of the link.")
    value: float = Field(description="Number of studies, or sum of their fractions.")
    studies: list[str]


class LeftOut(Shape):
    """Studies without a value at a level."""

    level: str
    count: int
    studies: list[str]


class Flows(Shape):
    """A decision flow: a Sankey diagram, or the rings of a sunburst."""

    chart: str = Field(description="Name of the chart.")
    levels: list[str] = Field(description="Attributes of the chart, from left to right.")
    counting: Literal["studies", "fractional"] = Field(description="studies or fractional.")
    studies: int = Field(description="Number of studies that match the filters.")
    nodes: list[Node]
    links: list[Link]
    left_out: list[LeftOut]


class TaxonomyValue(Shape):
    """A value of the taxonomy."""

    value: str
    name: str
    category: str
    section: str = Field(description="Label in the survey; empty where it has none.")
    section_name: str = Field(description="Name of the section, with printed number.")


class OfAttribute(Shape):
    """Of an attribute of the taxonomy."""

    attribute: str


# Members of a class stand behind those of the classes named after it.
class TaxonomyRow(TaxonomyValue, OfAttribute):
    """A value of the taxonomy with its attribute: a row of the table."""


class Taxonomy(Shape):
    """The vocabulary of the survey's mapping, by attribute."""

    attributes: dict[str, list[TaxonomyValue]]
