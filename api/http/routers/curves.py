"""/v1/curves: learning curves of the leading pipelines."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.base import Selected
from api.schema.curves import CurveRow, Curves, CurvesQuery
from api.schema.table import columns_of
from api.service.pagination import narrow, order, page
from api.web.answers import Answer, AnswerRoute, list_answer
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/curves", summary="Learning curves", response_model=Curves | Selected)
async def curves(known: Known, query: Annotated[CurvesQuery, Query()]) -> Answer:
    """Error against number of calibration poses, three leading pipelines of each data set.

    Each is calibrated on random subsets of the poses, on two sensor units, and scored on the whole
    test split. CSV: a row per pipeline, without the points.
    """
    rows = narrow(known.measurements.curves, query, ("dataset", "extractor", "model"))
    shown = page(order(rows, query.sort), "/v1/curves", query)
    return list_answer(shown, shown.items, columns_of(CurveRow), fields=query.fields)
