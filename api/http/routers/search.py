"""/v1/search: full-text search over all pages."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter, Query

from api.schema.search import Found, SearchQuery, SearchResults
from api.schema.table import columns_of
from api.service.pagination import page
from api.web.answers import Answer, AnswerRoute, list_answer
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/search", summary="Search", response_model=SearchResults)
async def search(known: Known, query: Annotated[SearchQuery, Query()]) -> Answer:
    """Search studies, algorithms, data sets, claims, attributes and terms.

    Exact names rank first, then results with all words.
    """
    hits = known.index.find(query.q, query.kind)
    ranked: list[dict[str, Any]] = []
    for rank, hit in enumerate(hits, start=1):
        entry = asdict(hit.entry)
        members = {name: entry[name] for name in ("kind", "id", "title", "address")}
        ranked.append({"rank": rank, **members, "excerpt": hit.excerpt, "score": hit.score})
    shown = page(ranked, "/v1/search", query)
    return list_answer(shown, shown.items, columns_of(Found))
