"""What the models of answers and of questions have in common."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Protocol

from pydantic import BaseModel, ConfigDict, Field, GetJsonSchemaHandler
from pydantic_core import CoreSchema

from api.dictionary import meaning
from api.http.models.parameters import GIVEN


class Described(BaseModel):
    """A model whose members are described: by itself, or by the data dictionary."""

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the JSON schema, with the dictionary's meaning where a member has none."""
        made = handler(schema)
        for name, member in handler.resolve_ref_schema(made).get("properties", {}).items():
            said = meaning(name)
            if said is not None:
                member.setdefault("description", said)
        return made


class Shape(Described):
    """An answer or a part of one: exactly these members."""

    model_config = ConfigDict(extra="forbid")


class OpenShape(Described):
    """An answer or a part of one whose producer may say more than these members."""

    model_config = ConfigDict(extra="allow")


class Listing(Shape):
    """A page of a list."""

    total: int = Field(description="Total number of items.")
    next: str | None = Field(description="Cursor of the next page; null on the last page.")


class Question(BaseModel):
    """The parameters of a query or a body: these and no others."""

    model_config = ConfigDict(extra="forbid")


class NoParameters(Question):
    """The query of an endpoint that takes none."""


class TableQuestion(Question):
    """The query of what can be had as a table."""

    format: Annotated[Literal["json", "csv"] | None, GIVEN] = Field(
        None,
        description=(
            "Response format; must be one the Accept header allows. "
            "By default the Accept header selects it."
        ),
    )
    safe: bool = Field(
        default=False,
        description="Escape CSV cells that a spreadsheet would run as formulas.",
    )


_CitedFormat = Literal["json", "csv", "bibtex", "ris", "csl"] | None


class CitedQuestion(TableQuestion):
    """The query of studies: a table, or references."""

    format: Annotated[_CitedFormat, GIVEN] = Field(  # type: ignore[assignment]  # more than a table
        None,
        description=(
            "Response format: JSON, CSV, or references to studies with a known title as "
            "BibTeX, RIS or CSL JSON; must be one the Accept header allows. By default "
            "the header decides."
        ),
    )


class OnlyFormat(TableQuestion):
    """The query of a table that takes no other parameters."""

    model_config = ConfigDict(json_schema_extra={"examples": [{}]})


class Selected(Shape):
    """A page with the columns of `fields`, as flat rows."""

    model_config = ConfigDict(extra="allow")

    items: list[dict[str, str | float | bool | list[Any] | dict[str, Any] | None]]
    total: int = Field(description="Total number of items.")
    next: str | None = Field(description="Cursor of the next page; null on the last page.")


class Paged(Protocol):
    """A question for a page of a list."""

    limit: int
    cursor: str | None

    def model_dump(self, *, exclude_defaults: bool) -> dict[str, Any]:
        """Return what is asked, as any model does."""
        ...
