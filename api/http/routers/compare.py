"""/v1/compare: pipelines of a data set, or architectures, side by side."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.comparison import CompareQuery, Comparison
from api.service import comparing as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/compare", summary="Comparison", response_model=Comparison)
async def compare(known: Known, query: Annotated[CompareQuery, Query()]) -> Answer:
    """Compare two to four pipelines of a data set, or two to four architectures.

    Error, bound, availability, time, calibration poses, errors by condition and off-axis angle, and
    studies. CSV: a row each, without errors by condition and angle.
    """
    return Answer.of(service.compare(known, query))
