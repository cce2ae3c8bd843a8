"""The implementations of extractors and models."""

from __future__ import annotations

from api.schema.algorithms import Algorithm, AlgorithmsQuery
from api.schema.table import columns_of
from api.service.documents import Document, list_document
from api.service.knowledge import Knowledge
from api.service.pagination import order, page


def algorithms(known: Knowledge, query: AlgorithmsQuery) -> Document:
    """List extractors and models with the survey's labels and the studies they are based on."""
    found = [
        implementation.to_dict() for implementation in known.catalogue.implementations(query.role)
    ]
    shown = page(order(found, query.sort), "/v1/algorithms", query)
    return list_document(shown, shown.items, columns_of(Algorithm), fields=query.fields)
