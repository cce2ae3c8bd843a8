"""/v1/curves: learning curves of the leading pipelines."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.base import Selected
from api.schema.curves import Curves, CurvesQuery
from api.service import scores as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/curves", summary="Learning curves", response_model=Curves | Selected)
async def curves(known: Known, query: Annotated[CurvesQuery, Query()]) -> Answer:
    """Error against number of calibration poses, three leading pipelines of each data set.

    Each is calibrated on random subsets of the poses, on two sensor units, and scored on the whole
    test split. CSV: a row per pipeline, without the points.
    """
    return Answer.of(service.curves(known, query))
