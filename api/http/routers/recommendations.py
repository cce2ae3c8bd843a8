"""/v1/recommendations: sensors and calibrations that meet requirements."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Query

from api.schema.recommendations import AnswerFlow, Designs, RecommendationRow, Recommendations
from api.schema.requirements import Requirements, RequirementsBody, RequirementsQuery
from api.schema.table import columns_of
from api.service import recommendations as service
from api.service.knowledge import Knowledge
from api.service.pagination import page
from api.web.answers import Answer, AnswerRoute, list_answer
from api.web.dependencies import AS_ACCEPTED, Known, TableOnly
from registry import answer as registered

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
    return recommended(query, known)


@router.post(
    "/recommendations",
    summary="Recommended sensors and calibrations (requirements in the body)",
    description=DESCRIPTION,
    response_model=Recommendations,
)
async def recommend(
    known: Known,
    body: Annotated[RequirementsBody, Body()],
    query: TableOnly = AS_ACCEPTED,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Recommend for requirements in a body."""
    return recommended(body, known)


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
    found = service.flow(_ask(query, known))
    return Answer(found.model_dump(), columns_of(AnswerFlow), list)


@router.get(
    "/recommendations/designs",
    summary="All calibrations of an answer",
    description="Every calibration that meets the requirements, as flat rows, paged.",
    response_model=Designs,
)
async def recommended_designs(known: Known, query: Annotated[RequirementsQuery, Query()]) -> Answer:
    """Return a page of all calibrations."""
    shown = service.design_page(_ask(query, known), query)
    items = [row.model_dump() for row in shown.items]
    return list_answer(shown, items, columns_of(RecommendationRow))


def recommended(asked: Requirements, known: Knowledge) -> Answer:
    """Return a page of the answer to requirements; its table has every calibration."""
    answer = _ask(asked, known)
    shown = page(answer.architectures, service.PATH, asked)
    document = service.document(answer, asked, shown.items, shown.next)
    table = columns_of(RecommendationRow)
    return Answer(
        document.model_dump(), table, lambda: [r.model_dump() for r in service.rows(answer)]
    )


def _ask(asked: Requirements, known: Knowledge) -> registered.Answer:
    return service.ask(asked, known.measured_pipelines, known.of(asked.edition).facts)
