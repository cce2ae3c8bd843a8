"""Search over all pages."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from api.schema.base import Shape, TableQuestion, example, page_of
from api.schema.parameters import GIVEN, Cursor, Limit, Several, several

Kind = Literal["study", "algorithm", "dataset", "claim", "attribute", "word"]


class SearchQuery(TableQuestion):
    """What is looked for."""

    model_config = example(q="treshold", kind=["algorithm"], limit=1)

    q: Annotated[str, GIVEN] = Field(
        min_length=1,
        max_length=200,
        description="Search words. Case, accents, endings and small spelling mistakes are "
        "tolerated.",
    )
    kind: Several[Kind] = several("Only results of this kind.")
    limit: Limit = 20
    cursor: Cursor = None


class Found(Shape):
    """A search result."""

    rank: int = Field(description="Position among the results, from 1.")
    kind: Kind
    id: str = Field(description="Name or key.")
    title: str
    excerpt: str = Field(description="Excerpt with a search word.")
    score: float = Field(description="BM25 score; exact names rank first.")
    address: str | None = Field(description="Address in the API.")


SearchResults = page_of(Found, "SearchResults", "A page of search results, best first.")
