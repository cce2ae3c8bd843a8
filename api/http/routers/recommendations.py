"""/v1/recommendations: ranked paths from a task to a calibrated sensor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

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
from api.http.recommended import encoded_answer
from api.http.recommended_table import table_text
from api.recommending import rows
from registry.recommendation import Answered, answered, recommendation
from registry.requirements import PARAMETERS, SETTINGS

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


class Recommended(Answer):
    """A recommendation: its JSON comes as bytes, its document is made where somebody reads it.

    Parameters
    ----------
    requirements : what is asked
    found : what meets them
    """

    def __init__(self, requirements: Requirements, found: Answered) -> None:
        self._requirements = requirements
        self._found = found
        self._document: Mapping[str, Any] | None = None
        super().__init__({}, columns.RECOMMENDATIONS, lambda: list(rows(self.document)))

    def render(self, content: Any) -> bytes:  # noqa: ARG002 - the document is not needed
        """Return the JSON."""
        asked = self._requirements
        body, self.digest = encoded_answer(self._found, asked.limit, asked.calibrations)
        return body

    def table(self) -> str:
        """Return the CSV."""
        return table_text(self._found, self._requirements.limit, self._requirements.calibrations)

    @property
    def document(self) -> Mapping[str, Any]:
        """The JSON object."""
        if self._document is None:
            asked = self._requirements
            told = recommendation(self._found, asked.limit, asked.calibrations)
            self._document = told.to_dict()
        return self._document

    @document.setter
    def document(self, _document: Mapping[str, Any]) -> None:
        """Leave it to who reads it."""


def _answer(requirements: Requirements, known: Knowledge) -> Recommended:
    given = requirements.model_fields_set
    asked = {
        name: getattr(requirements, name) for name in (*PARAMETERS, *SETTINGS) if name in given
    }
    studies = known.of(requirements.edition).facts
    found = answered(asked, known.measured, sort=requirements.sort, facts=studies)
    return Recommended(requirements, found)
