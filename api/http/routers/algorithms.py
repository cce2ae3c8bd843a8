"""/v1/algorithms: the implementations of extractors and models."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.algorithms import Algorithms, AlgorithmsQuery
from api.schema.base import Selected
from api.service import algorithms as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/algorithms", summary="Implementations", response_model=Algorithms | Selected)
async def algorithms(known: Known, query: Annotated[AlgorithmsQuery, Query()]) -> Answer:
    """List extractors and models with the survey's labels and the studies they are based on."""
    return Answer.of(service.algorithms(known, query))
