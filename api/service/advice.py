"""Advice of the survey, and rules for studies and scores."""

from __future__ import annotations

from api.schema.advice import Advice, AdviceQuery, Statement
from api.schema.table import columns_of
from api.service.documents import Document, list_document
from api.service.knowledge import Knowledge
from api.service.pagination import narrow, order, page
from api.service.protocol import protocol as statements


def advice(known: Knowledge, query: AdviceQuery) -> Document:
    """List the sensors and calibrations that the survey's text recommends, and for which tasks.

    Rows of errors name errors that occur, which is no recommendation.
    """
    found = narrow(known.advice, query, ("requirement", "detector", "mask"))
    shown = page(order(found, query.sort), "/v1/advice", query)
    return list_document(shown, shown.items, columns_of(Advice), fields=query.fields)


def protocol() -> Document:
    """Describe how the survey selected studies, and the rules of the scores.

    CSV: a row per sentence.
    """
    document = statements()
    return Document(
        document, columns_of(Statement), lambda: [*document["survey"], *document["scores"]]
    )
