"""/v1/assessment: properties of methods, as scored by the survey and as measured."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Query

from api.schema.assessment import Assessment, AssessmentQuery, VerdictRow
from api.schema.table import columns_of
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get(
    "/assessment",
    summary="Assessment of the survey, with measured scores",
    response_model=Assessment,
)
async def assessment(known: Known, query: Annotated[AssessmentQuery, Query()]) -> Answer:
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
    return Answer(document, columns_of(VerdictRow), lambda: rows)
