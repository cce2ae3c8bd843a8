"""/v1/results: every score."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.base import Selected
from api.schema.scores import Scores, ScoresQuery
from api.service import scores as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/results", summary="Scores", response_model=Scores | Selected)
async def results(known: Known, query: Annotated[ScoresQuery, Query()]) -> Answer:
    """Return scores: a row per data set, condition, extractor and model, including failures."""
    return Answer.of(service.results(known, query))
