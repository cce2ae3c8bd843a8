"""/v1/recommendations: ranked paths from a task to a calibrated sensor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from fastapi import APIRouter, Body, Query

from api.http.answers import Answer, AnswerRoute
from api.http.dependencies import NO_PARAMETERS, Known
from api.http.knowledge import Knowledge
from api.http.models.recommendations import Recommendations, Requirements, RequirementsBody
from registry.recommendation import Recommendation
from registry.recommendation import recommend as ranked

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)

COLUMNS = ("rank", "task", "detector", "mask", "model", "extractor", "studies", "pareto")
DESCRIPTION = (
    "Paths task > detector > mask > model > extractor that studies took and that meet the "
    "requirements, best backed first, with the measured performance beside. Values of one "
    "attribute are alternatives; different attributes must all hold. An empty answer names "
    "the constraint that blocks it and the relaxations that would help. As CSV: the paths."
)


@router.get(
    "/recommendations",
    summary="Which sensor, which calibration",
    description=DESCRIPTION,
    response_model=Recommendations,
)
async def recommendations(known: Known, query: Annotated[Requirements, Query()]) -> Answer:
    """Recommend for requirements in a query."""
    return _answer(query, known)


@router.post(
    "/recommendations",
    summary="Which sensor, which calibration (requirements in a body)",
    description=DESCRIPTION,
    response_model=Recommendations,
    dependencies=[NO_PARAMETERS],
)
async def recommend(known: Known, body: Annotated[RequirementsBody, Body()]) -> Answer:
    """Recommend for requirements in a body."""
    return _answer(body, known)


def _answer(requirements: Requirements, known: Knowledge) -> Answer:
    measured = known.measured_in(requirements.condition)
    asked = requirements.model_dump(exclude={"limit", "condition"})
    found = ranked(asked, measured, limit=requirements.limit, facts=known.facts)
    return Answer(found.to_dict(), COLUMNS, lambda: _rows(found))


def _rows(found: Recommendation) -> Sequence[Mapping[str, Any]]:
    """Return the paths as rows; a path that is not measured has empty measured cells."""
    nothing: dict[str, Any] = {}
    rows = [path.to_dict() for path in found.paths]
    return [{**row, "measured": row["measured"] or nothing} for row in rows]
