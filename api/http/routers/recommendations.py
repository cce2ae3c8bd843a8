"""/v1/recommendations: sensors and calibrations that meet requirements."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Query

from api.schema.recommendations import AnswerFlow, Designs, Recommendations
from api.schema.requirements import RequirementsBody, RequirementsQuery
from api.service import recommendations as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known, TableOnly

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)

DESCRIPTION = (
    "Ranks architectures (detector + mask) whose reported or measured evidence meets the "
    "requirements, each with its best calibration (extractor + compensations + model). Values of "
    "one attribute are alternatives; all other requirements must hold. An empty answer names the "
    "requirement that excludes all, and changes that would help. CSV: a row per calibration, all "
    "of them."
)


@router.get(
    "/recommendations",
    summary="Recommended sensors and calibrations",
    description=DESCRIPTION,
    response_model=Recommendations,
)
async def recommendations(known: Known, query: Annotated[RequirementsQuery, Query()]) -> Answer:
    """Recommend for requirements in a query."""
    return Answer.of(service.recommendations(known, query))


@router.post(
    "/recommendations",
    summary="Recommended sensors and calibrations (requirements in the body)",
    description=(
        "As GET, with the requirements as JSON. A list of one value may be given as that value."
    ),
    response_model=Recommendations,
)
async def recommend(
    known: Known,
    body: Annotated[RequirementsBody, Body()],
    query: TableOnly,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Recommend for requirements in a body."""
    return Answer.of(service.recommendations(known, body))


@router.get(
    "/recommendations/flow",
    summary="Decision flow of an answer",
    description="Studies behind an answer, as paths, nodes and links from task to extractor.",
    response_model=AnswerFlow,
)
async def recommendations_flow(
    known: Known, query: Annotated[RequirementsQuery, Query()]
) -> Answer:
    """Return the flow of studies behind an answer."""
    return Answer.of(service.flow_of_answer(known, query))


@router.get(
    "/recommendations/designs",
    summary="All calibrations of an answer",
    description="Every calibration that meets the requirements, as flat rows, paged.",
    response_model=Designs,
)
async def recommended_designs(known: Known, query: Annotated[RequirementsQuery, Query()]) -> Answer:
    """Return a page of all calibrations."""
    return Answer.of(service.designs(known, query))
