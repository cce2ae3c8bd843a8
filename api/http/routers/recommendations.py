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
from api.http.recommended import document
from api.recommending import rows
from registry.recommendation import answered
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
    return Recommended(query, known)


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
    return Recommended(body, known)


class Recommended(Answer):
    """A recommendation: its JSON comes as bytes, its document is made where somebody reads it.

    Parameters
    ----------
    requirements : what is asked
    known : what is told
    """

    def __init__(self, requirements: Requirements, known: Knowledge) -> None:
        self._requirements = requirements
        self._known = known
        super().__init__({}, columns.RECOMMENDATIONS, lambda: list(rows(self.document)))

    def render(self, content: Any) -> bytes:  # noqa: ARG002 - the document is not needed
        """Return the JSON."""
        asked = self._requirements
        found = answered(
            _parameters(asked), self._known.measured, sort=asked.sort, facts=self._known.facts
        )
        return document(found, asked.limit, asked.calibrations)

    @property
    def document(self) -> Mapping[str, Any]:
        """The JSON object."""
        asked = self._requirements
        return ranked(
            _parameters(asked),
            self._known.measured,
            sort=asked.sort,
            limit=asked.limit,
            calibrations=asked.calibrations,
            facts=self._known.facts,
        ).to_dict()

    @document.setter
    def document(self, _document: Mapping[str, Any]) -> None:
        """Leave it to be made."""


def _parameters(requirements: Requirements) -> dict[str, Any]:
    about_answer = {"limit", "calibrations", "sort", "format"}
    return {name: value for name, value in requirements if name not in about_answer}
