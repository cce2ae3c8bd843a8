"""The implementations of extractors and models."""

from __future__ import annotations

from api.schema.algorithms import Algorithm, AlgorithmsQuery
from api.service.documents import Document, listing
from api.service.knowledge import Knowledge


def algorithms(known: Knowledge, query: AlgorithmsQuery) -> Document:
    """List extractors and models with the survey's labels and the studies they are based on."""
    found = [
        implementation.to_dict() for implementation in known.catalogue.implementations(query.role)
    ]
    return listing(found, "/v1/algorithms", query, Algorithm)
