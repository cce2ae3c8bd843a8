"""/v1/assessment: what methods can do, as the survey says and as measured."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Query

from api import columns
from api.http.answers import Answer, AnswerRoute
from api.http.dependencies import Known
from api.http.models.assessment import Assessment, AssessmentQuery

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get(
    "/assessment",
    summary="The survey's assessment beside the measured one",
    response_model=Assessment,
)
async def assessment(known: Known, query: Annotated[AssessmentQuery, Query()]) -> Answer:
    """Scores 2 (provides), 1 (partly), 0 (does not) of 19 methods in 21 properties.

    Each tells what the survey says, what was measured by the stated definition, and whether they
    agree. As CSV: a row a method and property.
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
    return Answer(document, columns.ASSESSMENT, lambda: rows)
