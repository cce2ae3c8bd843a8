"""/v1/advice and /v1/protocol: advice of the survey; rules for studies and scores."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.advice import AdviceQuery, Advices, Protocol
from api.schema.base import Selected
from api.service import advice as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known, TableOnly

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/advice", summary="The survey's advice", response_model=Advices | Selected)
async def advice(known: Known, query: Annotated[AdviceQuery, Query()]) -> Answer:
    """List the sensors and calibrations that the survey's text recommends, and for which tasks.

    Rows of errors name errors that occur, which is no recommendation.
    """
    return Answer.of(service.advice(known, query))


@router.get("/protocol", summary="Rules for studies and scores", response_model=Protocol)
async def protocol(
    known: Known,  # noqa: ARG001 - as every path function has it
    query: TableOnly,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Describe how the survey selected studies, and the rules of the scores.

    CSV: a row per sentence.
    """
    return Answer.of(service.protocol())
