"""Properties of methods, as scored by the survey and as measured."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from api.schema.assessment import AssessmentQuery, VerdictRow
from api.schema.table import columns_of
from api.service.documents import Document
from api.service.knowledge import Knowledge


def assessment(known: Knowledge, query: AssessmentQuery) -> Document:
    """Scores 2 (yes), 1 (partly), 0 (no) of 19 methods and 21 properties.

    Each has the score of the survey, the measured score and their agreement. CSV: a row per method
    and property.
    """
    whole = known.measurements.assessment
    methods = [m for m in whole["methods"] if not query.method or m["method"] in query.method]
    rows: list[Mapping[str, Any]] = [
        {**{name: method[name] for name in ("method", "taxonomy", "case_study")}, **verdict}
        for method in methods
        for verdict in method["properties"]
    ]
    totals = {name: sum(method["counts"][name] for method in methods) for name in whole["totals"]}
    document = {"definitions": whole["definitions"], "methods": methods, "totals": totals}
    return Document(document, columns_of(VerdictRow), lambda: rows)
