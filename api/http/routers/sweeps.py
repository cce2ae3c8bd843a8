"""/v1/sweeps: errors on reference features."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.assessment import Sweep, Sweeps, SweepsQuery
from api.schema.base import Selected
from api.schema.table import columns_of
from api.service.pagination import narrow, order, page
from api.web.answers import Answer, AnswerRoute, list_answer
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/sweeps", summary="Sweeps on reference features", response_model=Sweeps | Selected)
async def sweeps(known: Known, query: Annotated[SweepsQuery, Query()]) -> Answer:
    """Return the error of every extractor against noise, feature size, sub-pixel phase and more.

    The features are known in closed form; each point has its Cramer-Rao bound. A row without a
    sweep gives the reason why an extractor is not measured.
    """
    rows = narrow(known.measurements.sweeps, query, ("series", "sweep", "extractor"))
    shown = page(order(rows, query.sort), "/v1/sweeps", query)
    return list_answer(shown, shown.items, columns_of(Sweep), fields=query.fields)
