"""What the models of answers and of questions have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal, Protocol

from pydantic import BaseModel, ConfigDict, Field, GetJsonSchemaHandler, create_model
from pydantic_core import CoreSchema

from api.schema.former_names import MEMBERS
from api.schema.parameters import DEFAULT_PAGE, FIELDS, GIVEN, SORT, Cursor, Limit, OneOf, Several
from api.schema.table import Model, columns_of, sortable
from api.schema.vocabulary import meaning
from survey_data.editions import Choice


def example(**asked: Any) -> ConfigDict:
    """Return the settings of a question with an example of it, for its documentation."""
    return ConfigDict(json_schema_extra={"examples": [asked]})


class Described(BaseModel):
    """A model whose members are described: by itself, or by the vocabulary."""

    model_config = ConfigDict(defer_build=True)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the JSON schema, with what each member means."""
        made = handler(schema)
        members = handler.resolve_ref_schema(made).get("properties", {})
        for name, member in members.items():
            if said := meaning(name, member.get("description")):
                member["description"] = said
        for new, old in MEMBERS.items():
            if new in members:
                members[old] = {"description": f"Old name of {new}.", "deprecated": True}
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


def page_of(row: Model, name: str, words: str) -> Any:
    """Return the model of a page of a list of such rows; `words` describe it."""
    items: Any = (list[row], ...)  # type: ignore[valid-type]
    return create_model(name, __base__=Listing, __doc__=words, __module__=__name__, items=items)


class Question(BaseModel):
    """The parameters of a query or a body: these and no others."""

    model_config = ConfigDict(extra="forbid")


class NoParameters(Question):
    """The query of an endpoint that takes none."""


class OfEdition(Question):
    """Of which edition of the studies."""

    edition: Choice = Field("survey", description="Studies of the survey, or all added ones too.")


class TableQuestion(Question):
    """The query of what can be had as a table."""

    format: Annotated[Literal["json", "csv"] | None, GIVEN] = Field(
        None,
        description="Response format; must be one the Accept header allows. By default the Accept "
        "header selects it.",
    )
    safe: bool = Field(default=False, description="Escape cells that a spreadsheet would run.")


class SortedQuestion(TableQuestion):
    """The query of a list: filters, then an order, columns and a page.

    A subclass names the model of a row, `rows`, whose columns can be sorted by and chosen.
    """

    if TYPE_CHECKING:
        sort: str | None
        fields: list[str]
        limit: int
        cursor: str | None

    def __init_subclass__(cls, rows: Model | None = None, **settings: Any) -> None:
        """Add the parameters that a list of such rows has, after the filters."""
        super().__init_subclass__(**settings)
        if rows is None:
            return
        by = OneOf(lambda: [f"{sign}{name}" for name in sortable(rows) for sign in ("", "-")])
        cls.__annotations__ |= {
            "sort": Annotated[str | None, by, GIVEN],
            "fields": Several[Annotated[str, OneOf(lambda: list(columns_of(rows)))]],
            "limit": Limit,
            "cursor": Cursor,
        }
        cls.sort, cls.fields, cls.limit, cls.cursor = SORT, FIELDS, DEFAULT_PAGE, None


_CitedFormat = Literal["json", "csv", "bibtex", "ris", "csl"] | None


class CitedQuestion(TableQuestion):
    """The query of studies: a table, or references."""

    format: Annotated[_CitedFormat, GIVEN] = Field(  # type: ignore[assignment]  # more than a table
        None,
        description="Response format: JSON, CSV, or references to studies with a known title as "
        "BibTeX, RIS or CSL JSON; must be one the Accept header allows. By default the header "
        "decides.",
    )


class DrawnQuestion(TableQuestion):
    """The query of a figure: a table, or what Plotly draws."""

    format: Annotated[Literal["json", "csv", "plotly"] | None, GIVEN] = Field(  # type: ignore[assignment]  # as above
        None,
        description="Response format: JSON, CSV, or the figure as Plotly JSON (`data` and "
        "`layout`); must be one the Accept header allows. By default the header decides.",
    )


class OnlyFormat(TableQuestion):
    """The query of a table that takes no other parameters."""

    model_config = example()


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
