"""/v1/taxonomy: the vocabulary of the survey."""

from __future__ import annotations

from fastapi import APIRouter

from api.schema.taxonomy import Taxonomy
from api.service import taxonomy as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known, TableOnly

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get(
    "/taxonomy",
    summary="Vocabulary of the survey",
    response_model=Taxonomy,
)
async def taxonomy(
    known: Known,
    query: TableOnly,  # noqa: ARG001 - the route has read it
) -> Answer:
    """List all values of all attributes of studies.

    Each has name, category and section of the survey. Other endpoints take them as filters.
    """
    return Answer.of(service.taxonomy(known))
