"""Full-text search over all pages."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from api.schema.search import Found, SearchQuery
from api.service.documents import Document, listing
from api.service.knowledge import Knowledge


def search(known: Knowledge, query: SearchQuery) -> Document:
    """Search studies, algorithms, data sets, claims, attributes and terms.

    Exact names rank first, then results with all words.
    """
    hits = known.index.find(query.q, query.kind)
    ranked: list[dict[str, Any]] = []
    for rank, hit in enumerate(hits, start=1):
        entry = asdict(hit.entry)
        members = {name: entry[name] for name in ("kind", "id", "title", "address")}
        ranked.append({"rank": rank, **members, "excerpt": hit.excerpt, "score": hit.score})
    return listing(ranked, "/v1/search", query, Found)
