"""/v1/results: every score."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.base import Selected
from api.schema.scores import Score, Scores, ScoresQuery
from api.schema.table import columns_of
from api.service.pagination import narrow, order, page
from api.web.answers import Answer, AnswerRoute, list_answer
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/results", summary="Scores", response_model=Scores | Selected)
async def results(known: Known, query: Annotated[ScoresQuery, Query()]) -> Answer:
    """Return scores: a row per data set, condition, extractor and model, including failures."""
    names = ("dataset", "condition", "extractor", "model")
    rows = order(narrow(known.measurements.scores, query, names), query.sort)
    shown = page(rows, "/v1/results", query)
    return list_answer(shown, shown.items, columns_of(Score), fields=query.fields)
