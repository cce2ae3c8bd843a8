"""/v1/results: every score."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.http.answers import Answer, AnswerRoute, listing
from api.http.dependencies import Known
from api.http.models.scores import Scores, ScoresQuery
from api.http.pagination import narrowed, page

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)

COLUMNS = (
    *("dataset", "condition", "extractor", "model", "status", "rms_deg", "bound_deg"),
    *("bound_unit_deg", "floor_deg"),
)


@router.get("/results", summary="The scores", response_model=Scores)
async def results(known: Known, query: Annotated[ScoresQuery, Query()]) -> Answer:
    """One row a data set, condition, extractor and model, failures included."""
    names = ("dataset", "condition", "extractor", "model")
    shown = page(narrowed(known.measurements.scores, query, names), "/v1/results", query)
    return listing(shown, shown.items, COLUMNS)
