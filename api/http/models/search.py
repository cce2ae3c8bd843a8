"""Search over all that is told."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from api.http.models.base import Listing, Shape, TableQuestion
from api.http.models.parameters import GIVEN, Cursor, Limit, Several, several

Kind = Literal["study", "algorithm", "dataset", "claim", "attribute", "word"]


class SearchQuery(TableQuestion):
    """What is looked for."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"q": "treshold", "kind": ["algorithm"], "limit": 1}]}
    )

    q: Annotated[str, GIVEN] = Field(
        min_length=1,
        max_length=200,
        description="Words. Case, accents and endings do not matter, a slip of the keyboard is "
        "forgiven.",
    )
    kind: Several[Kind] = several("Only things of this kind.")
    limit: Limit = 20
    cursor: Cursor = None


class Found(Shape):
    """A thing found."""

    rank: int = Field(description="Place among all that is found, from 1.")
    kind: Kind
    id: str = Field(description="Its name among its kind.")
    title: str
    excerpt: str = Field(description="Where its text has one of the words.")
    score: float = Field(
        description="By BM25F; what has all words comes first whatever its score, and what is "
        "called just so before that."
    )
    address: str | None = Field(description="Where this service tells of it.")


class SearchResults(Listing):
    """A page of what is found, the best first."""

    items: list[Found]
