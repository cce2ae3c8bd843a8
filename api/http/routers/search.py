"""/v1/search: full-text search over all pages."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.search import SearchQuery, SearchResults
from api.service import search as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/search", summary="Search", response_model=SearchResults)
async def search(known: Known, query: Annotated[SearchQuery, Query()]) -> Answer:
    """Search studies, algorithms, data sets, claims, attributes and terms.

    Exact names rank first, then results with all words.
    """
    return Answer.of(service.search(known, query))
