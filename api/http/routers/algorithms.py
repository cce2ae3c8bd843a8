"""/v1/algorithms: the implementations of extractors and models."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.schema.algorithms import Algorithm, Algorithms, AlgorithmsQuery
from api.schema.base import Selected
from api.schema.table import columns_of
from api.service.pagination import order, page
from api.web.answers import Answer, AnswerRoute, list_answer
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/algorithms", summary="Implementations", response_model=Algorithms | Selected)
async def algorithms(known: Known, query: Annotated[AlgorithmsQuery, Query()]) -> Answer:
    """List extractors and models with the survey's labels and the studies they are based on."""
    found = [
        implementation.to_dict() for implementation in known.catalogue.implementations(query.role)
    ]
    shown = page(order(found, query.sort), "/v1/algorithms", query)
    return list_answer(shown, shown.items, columns_of(Algorithm), fields=query.fields)
