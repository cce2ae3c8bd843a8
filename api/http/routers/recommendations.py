"""/v1/recommendations: ranked paths from a task to a calibrated sensor."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Body, Query

from api.http.queries import QueryRoute
from api.recommending import rows
from api.schema.recommendations import RecommendationRow, Recommendations
from api.schema.requirements import Requirements, RequirementsBody, RequirementsQuery
from api.schema.table import columns_of
from api.service.knowledge import Knowledge
from api.web.answers import Answer
from api.web.dependencies import AS_ACCEPTED, Known, TableOnly
from api.web.representations import digest_of
from registry.answer_json import answer_digest, answer_json
from registry.recommendation import answer
from registry.requirements import PARAMETERS, SETTINGS

router = APIRouter(prefix="/v1", route_class=QueryRoute, default_response_class=Answer)

DESCRIPTION = (
    "Ranks architectures (detector + mask) and their calibrations (extractor + compensations + "
    "model) that meet the requirements. Three kinds of evidence: advised by the survey, used in "
    "studies, measured here. Values of one attribute are alternatives; all other requirements "
    "must hold. An empty answer names the requirement that excludes all, and changes that would "
    "help. CSV: a row per calibration."
)


@router.get(
    "/recommendations",
    summary="Recommended sensors and calibrations",
    description=DESCRIPTION,
    response_model=Recommendations,
)
async def recommendations(known: Known, query: Annotated[RequirementsQuery, Query()]) -> Answer:
    """Recommend for requirements in a query."""
    return _answer(query, known)


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
    return _answer(body, known)


class Recommendation(Answer):
    """A recommendation, written as JSON already; its table is made from that where it is asked for.

    Parameters
    ----------
    content : the JSON
    digest : what its ETag is made of
    """

    def __init__(self, content: bytes, digest: str) -> None:
        self._content = content
        self.digest = digest
        super().__init__({}, columns_of(RecommendationRow), lambda: list(rows(self.document)))

    def render(self, content: Any) -> bytes:  # noqa: ARG002 - written already
        """Return the JSON."""
        return self._content

    @property
    def document(self) -> Mapping[str, Any]:
        """The JSON object."""
        document: Mapping[str, Any] = json.loads(self._content)
        return document

    @document.setter
    def document(self, _document: Mapping[str, Any]) -> None:
        """Ignore the empty one of `Answer`."""


def _answer(requirements: Requirements, known: Knowledge) -> Recommendation:
    given = requirements.model_fields_set
    asked = {
        name: getattr(requirements, name) for name in (*PARAMETERS, *SETTINGS) if name in given
    }
    studies = known.of(requirements.edition).facts
    found = answer(asked, known.measured_pipelines, sort=requirements.sort, facts=studies)
    shown = (requirements.limit, requirements.calibrations)
    digest = digest_of(answer_digest(found, *shown))
    return Recommendation(answer_json(found, *shown), digest)
