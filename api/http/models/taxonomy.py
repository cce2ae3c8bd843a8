"""The vocabulary."""

from __future__ import annotations

from pydantic import Field

from api.http.models.base import Shape


class TaxonomyValue(Shape):
    """A value of the taxonomy."""

    value: str
    name: str
    category: str
    section: str = Field(description="Label in the survey; empty where it has none.")
    section_name: str = Field(description="Name of the section, with printed number.")


class Taxonomy(Shape):
    """The vocabulary of the survey's mapping, by attribute."""

    attributes: dict[str, list[TaxonomyValue]]
