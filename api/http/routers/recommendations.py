"""/v1/recommendations: ranked paths from a task to a calibrated sensor."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Query

from api import columns
from api.http.answers import Answer, AnswerRoute
from api.http.dependencies import AS_ACCEPTED, Known, TableOnly
from api.http.knowledge import Knowledge
from api.http.models.recommendations import (
    Recommendations,
    Requirements,
    RequirementsBody,
    RequirementsQuery,
)
from api.recommending import rows
from registry.recommendation import recommend as ranked

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)

DESCRIPTION = (
    "Which sensor: detector and mask. How to calibrate it: extractor, compensations, model. Three "
    "kinds of evidence stay apart: what the survey advises, what studies proposed, what is "
    "measured here. Values of one attribute are alternatives; all else must hold. An empty answer "
    "names what blocks it and what would help. As CSV: a row a calibration."
)


@router.get(
    "/recommendations",
    summary="Which sensor, which calibration",
    description=DESCRIPTION,
    response_model=Recommendations,
)
async def recommendations(known: Known, query: Annotated[RequirementsQuery, Query()]) -> Answer:
    """Recommend for requirements in a query."""
    return _answer(query, known)


@router.post(
    "/recommendations",
    summary="Which sensor, which calibration (requirements in a body)",
    description=DESCRIPTION,
    response_model=Recommendations,
)
async def recommend(
    known: Known,
    body: Annotated[RequirementsBody, Body()],
    query: TableOnly = AS_ACCEPTED,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Recommend for requirements in a body."""
    return _answer(body, known)


def _answer(requirements: Requirements, known: Knowledge) -> Answer:
    asked = requirements.model_dump(exclude={"limit", "calibrations", "sort", "format"})
    found = ranked(
        asked,
        known.measured,
        sort=requirements.sort,
        limit=requirements.limit,
        calibrations=requirements.calibrations,
        facts=known.facts,
    )
    document = found.to_dict()
    return Answer(document, columns.RECOMMENDATIONS, lambda: list(rows(document)))
