"""/v1/flows/{chart}: the survey's decision flows."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from api.schema.flows import Flows, FlowsQuery
from api.schema.words import Chart
from api.service import taxonomy as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/flows/{chart}", summary="A decision flow", response_model=Flows)
async def flows(
    known: Known,
    chart: Annotated[Chart, Path(description="Chart.", examples=["error"])],
    query: Annotated[FlowsQuery, Query()],
) -> Answer:
    """Return nodes and links of a diagram of the survey, with their studies.

    Filters keep the studies with one of the values. CSV: the links.
    """
    return Answer.of(service.flows(known, chart, query))
