"""The survey's figures, of the current data."""

from __future__ import annotations

from typing import Any

from api.figures.catalogue import LEVELS, TITLES, FigureName, evidence_map
from api.figures.catalogue import figure as drawn
from api.figures.figure import Figure
from api.schema.figures import FigureQuery, ListedFigure, MatrixQuery
from api.schema.measured_figures import MeasuredFigure
from api.schema.table import columns_of
from api.service.documents import Document
from api.service.knowledge import Knowledge


def figures(known: Knowledge) -> Document:
    """List the figures and the attributes they show. The evidence map is `matrix`."""
    items = [
        {"figure": name, "title": title, "caption": caption, "levels": list(LEVELS[name])}
        for name, (title, caption) in TITLES.items()
    ]
    document = {"items": items, "studies": len(known.facts.studies)}
    return Document(document, columns_of(ListedFigure), lambda: items)


def matrix(known: Knowledge, query: MatrixQuery) -> Document:
    """Return the evidence map: one row per pair of values.

    `state` is `measured` (scored here, with the best own error), `studied`, `impossible` (with the
    `reason`), `unknown` (a study has one value, the other is unknown) or `unstudied`. `command` and
    `leads_to` show how to measure the pair.
    """
    studies = known.of(query.edition).facts
    asked = (query.by_attribute(), query.rows, query.columns)
    return document_of(evidence_map(studies, *asked, evidence=known.evidence))


def figure(known: Knowledge, figure: FigureName, query: FigureQuery) -> Document:
    """Return a figure as sentences and as a table, with the studies of every mark.

    CSV: a row per mark.
    """
    return document_of(drawn(figure, known.of(query.edition).facts, query.by_attribute()))


def document_of(found: Figure) -> Document:
    """Return a figure as a document."""
    return Document(found.to_dict(), found.columns, lambda: found.rows, plotly=found.plotly)


def measured_document(found: Figure, model: type[MeasuredFigure], **more: Any) -> Document:
    """Return a figure of measurements as a document; its rows are called items."""
    made: dict[str, Any] = {
        "figure": found.name,
        **{name: getattr(found, name) for name in ("title", "caption", "text", "options")},
        "items": found.rows,
        **more,
    }
    document = model(**made).model_dump()
    return Document(document, found.columns, lambda: found.rows, plotly=found.plotly)
