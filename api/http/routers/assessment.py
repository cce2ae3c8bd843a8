"""/v1/assessment: properties of methods, as scored by the survey and as measured."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.assessment import Assessment, AssessmentQuery
from api.service import assessment as service
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
    return Answer.of(service.assessment(known, query))
