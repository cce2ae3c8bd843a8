"""/v1/realism: the standard data sets beside built sensors."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.datasets import Realism, RealismQuery
from api.service import datasets as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/realism", summary="Data sets compared with built sensors", response_model=Realism)
async def realism(known: Known, query: Annotated[RealismQuery, Query()]) -> Answer:
    """Compare each data set with built sensors and their published figures.

    Our accuracy is the RMS of unit 0 of the best pipeline under nominal conditions, on the standard
    bench; our precision is its repeatability. CSV: a row per data set and sensor.
    """
    return Answer.of(service.realism(known, query))
