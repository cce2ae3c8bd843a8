"""The vocabulary of the survey, and its decision flows."""

from __future__ import annotations

from api.schema.flows import FlowsQuery, Link, TaxonomyRow
from api.schema.table import columns_of
from api.schema.words import Chart
from api.service.documents import Document
from api.service.knowledge import Knowledge
from registry.flows import chart as flows_of


def taxonomy(known: Knowledge) -> Document:
    """List all values of all attributes of studies.

    Each has name, category and section of the survey. Other endpoints take them as filters.
    """
    attributes = known.taxonomy.to_dict()
    return Document(
        {"attributes": attributes},
        columns_of(TaxonomyRow),
        lambda: [
            {"attribute": attribute, **entry}
            for attribute, entries in attributes.items()
            for entry in entries
        ],
    )


def flows(known: Knowledge, chart: Chart, query: FlowsQuery) -> Document:
    """Return nodes and links of a diagram of the survey, with their studies.

    Filters keep the studies with one of the values. CSV: the links.
    """
    studies = known.of(query.edition).facts
    found = flows_of(
        chart, query.by_attribute(), query.counting, grouped=query.grouped, facts=studies
    )
    return Document(
        found.to_dict(), columns_of(Link), lambda: [link.to_dict() for link in found.links]
    )
