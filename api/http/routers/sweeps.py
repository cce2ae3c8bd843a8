"""/v1/sweeps: errors on reference features."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.assessment import Sweeps, SweepsQuery
from api.schema.base import Selected
from api.service import scores as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/sweeps", summary="Sweeps on reference features", response_model=Sweeps | Selected)
async def sweeps(known: Known, query: Annotated[SweepsQuery, Query()]) -> Answer:
    """Return the error of every extractor against noise, feature size, sub-pixel phase and more.

    The features are known in closed form; each point has its Cramer-Rao bound. A row without a
    sweep gives the reason why an extractor is not measured.
    """
    return Answer.of(service.sweeps(known, query))
