"""/search: full-text search over all pages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from fastapi import Query
from pydantic import Field

from api import addresses
from api.pages.serving import PageRouter, View
from api.pages.terms import glossary
from api.schema.base import Question
from api.schema.parameters import GIVEN, Several, several
from api.service.documents import Document
from api.service.index.entries import KINDS
from api.service.index.index import Entry
from api.web.dependencies import Known
from registry.taxonomy import ATTRIBUTES

router = PageRouter()

MOST = 60
FEW = 4
"""Hits of a kind that are shown where all kinds are asked for."""
COLUMNS = ("kind", "id", "title", "excerpt", "score", "page")
KIND_NAMES = {
    "study": "Studies",
    "algorithm": "Algorithms",
    "dataset": "Data sets",
    "claim": "Claims",
    "attribute": "Attributes",
    "word": "Words",
}
_PAGES = {
    "study": addresses.study_page,
    "algorithm": addresses.algorithm_page,
    "dataset": addresses.dataset_page,
    "claim": addresses.claim_page,
}


class SearchQuery(Question):
    """What is looked for."""

    q: Annotated[
        str | None, Field(min_length=1, max_length=200, description="Words, in any order."), GIVEN
    ] = None
    kind: Several[str] = several("Only what is of one of these kinds.")


@router.page("/search")
async def search(known: Known, query: Annotated[SearchQuery, Query()]) -> View:
    """Tell what is found, the best first."""
    kinds = [kind for kind in query.kind or () if kind in KINDS]
    hits = known.index.find(query.q, kinds) if query.q else []
    items: list[dict[str, Any]] = [
        {
            "kind": hit.entry.kind,
            "id": hit.entry.id,
            "title": hit.entry.title,
            "excerpt": hit.excerpt,
            "score": hit.score,
            "page": page_of(hit.entry),
        }
        for hit in hits
    ]
    shown = items[:MOST]
    document = {"q": query.q, "items": shown, "total": len(hits)}
    return View(
        "search.html",
        Document(document, COLUMNS, lambda: shown),
        asked=query,
        kinds=KIND_NAMES,
        groups=_grouped(shown if query.kind else items),
        few=FEW,
        verdicts={
            key: one.verdict or "not measured" for key, one in known.measurements.claims.items()
        },
    )


def _grouped(items: Sequence[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    """Return what is found by kind, the kind of the best hit first."""
    of: dict[str, list[dict[str, Any]]] = {}
    for item in items:
        of.setdefault(item["kind"], []).append(item)
    return [*of.values()]


def page_of(entry: Entry) -> str:
    """Return the address of the page that tells of what was found."""
    if entry.kind in _PAGES:
        return _PAGES[entry.kind](entry.id)
    attribute, _, value = entry.id.partition(": ")
    if value and attribute in ATTRIBUTES:
        return addresses.value_page(attribute, value)
    if entry.kind == "attribute":
        return f"/glossary#{addresses.anchor('attribute', entry.id)}"
    known = entry.id in glossary()
    return f"/glossary#{addresses.anchor('term', entry.id)}" if known else "/glossary"
