"""/v1/recommendations: ranked paths from a task to a calibrated sensor."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Body, Query

from api.http.answers import Answer, AnswerRoute
from api.http.dependencies import NO_PARAMETERS, Known
from api.http.knowledge import Knowledge
from api.http.models.recommendations import Recommendations, Requirements, RequirementsBody
from registry.recommendation import recommend as ranked

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)

COLUMNS = (
    *("rank", "detector", "mask", "advised", "studies", "pareto", "calibration"),
    *("extractor", "compensations", "model", "calibration_studies", "support"),
)
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
    asked = requirements.model_dump(exclude={"limit", "calibrations", "sort"})
    found = ranked(
        asked,
        known.measured,
        sort=requirements.sort,
        limit=requirements.limit,
        calibrations=requirements.calibrations,
        facts=known.facts,
    )
    document = found.to_dict()
    return Answer(document, COLUMNS, lambda: list(rows(document)))


def rows(document: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield a row a calibration of an answer; what is not measured has empty measured cells."""
    for architecture in document["architectures"]:
        for calibration in architecture["calibrations"]:
            yield {
                **{name: architecture[name] for name in COLUMNS[:6]},
                "calibration": calibration["rank"],
                **{name: calibration[name] for name in ("extractor", "compensations", "model")},
                "calibration_studies": calibration["studies"],
                "support": calibration["support"],
                "measured": calibration["measured"] or {},
            }
