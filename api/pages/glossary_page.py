"""/glossary: every term and abbreviation, and the words of the survey's taxonomy."""

from __future__ import annotations

from api.pages.serving import PageRouter, View
from api.pages.study import NAMES
from api.pages.terms import glossary
from api.service.documents import Document
from api.web.dependencies import Known

router = PageRouter()

COLUMNS = ("term", "short", "meaning")


@router.page("/glossary")
async def words(known: Known) -> View:
    """All terms in alphabetical order, and the taxonomy by attribute."""
    every = glossary().values()
    terms = [{"term": t.term, "short": t.name, "meaning": t.meaning} for t in every]
    taxonomy = known.taxonomy.to_dict()
    document = {"terms": terms, "taxonomy": taxonomy}
    return View(
        "glossary.html",
        Document(document, COLUMNS, lambda: terms),
        terms=every,
        taxonomy=taxonomy,
        names=NAMES,
    )
