"""The vocabulary."""

from __future__ import annotations

from pydantic import Field

from api.schema.base import Shape


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
