"""/v1/claims: the survey's statements about algorithms, with verdicts."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from api.schema.base import Selected
from api.schema.claims import ClaimDetail, Claims, ClaimsQuery
from api.schema.words import ClaimId
from api.service import claims as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known, TableOnly

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/claims", summary="Claims of the survey, tested", response_model=Claims | Selected)
async def claims(known: Known, query: Annotated[ClaimsQuery, Query()]) -> Answer:
    """List claims of the survey with their verdicts.

    CSV: a row per claim.
    """
    return Answer.of(service.claims(known, query))


@router.get(
    "/claims/{id}",
    summary="A claim",
    response_model=ClaimDetail,
)
async def claim(
    known: Known,
    id: Annotated[ClaimId, Path(description="Claim, such as C29.", examples=["C04"])],  # noqa: A002 - the parameter's name
    query: TableOnly,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Return a claim with its criteria, the results of all trials and its plot.

    CSV: the criteria.
    """
    return Answer.of(service.claim(known, id))
