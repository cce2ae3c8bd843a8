"""/v1/algorithms: the implementations of extractors and models."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from api.http.answers import Answer, AnswerRoute, listing
from api.http.dependencies import Known
from api.http.models.algorithms import Algorithm, Algorithms, AlgorithmsQuery
from api.http.pagination import page

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/algorithms", summary="The implementations", response_model=Algorithms)
async def algorithms(known: Known, query: Annotated[AlgorithmsQuery, Query()]) -> Answer:
    """Extractors and models, each with the value it implements and the studies it follows."""
    shown = page(known.catalogue.listing(query.role), "/v1/algorithms", query)
    items = [implementation.to_dict() for implementation in shown.items]
    return listing(shown, items, tuple(Algorithm.model_fields))
