"""/v1/figures: the survey's figures, drawn from the current data."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from api.figures.catalogue import FigureName
from api.schema.figures import Figure, FigureQuery, Figures, MatrixQuery
from api.service import figures as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known, TableOnly

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get("/figures", summary="The survey's figures", response_model=Figures)
async def figures(
    known: Known,
    query: TableOnly,  # noqa: ARG001 - the route has read it
) -> Answer:
    """List the figures and the attributes they show. The evidence map is `matrix`."""
    return Answer.of(service.figures(known))


@router.get(
    "/figures/matrix", summary="Evidence map: studies by two attributes", response_model=Figure
)
async def matrix(known: Known, query: Annotated[MatrixQuery, Query()]) -> Answer:
    """Return the evidence map: one row per pair of values.

    `state` is `measured` (scored here, with the best own error), `studied`, `impossible` (with the
    `reason`), `unknown` (a study has one value, the other is unknown) or `unstudied`. `command` and
    `leads_to` show how to measure the pair.
    """
    return Answer.of(service.matrix(known, query))


@router.get("/figures/{figure}", summary="A figure of the survey", response_model=Figure)
async def figure(
    known: Known,
    figure: Annotated[FigureName, Path(description="Figure.", examples=["performance"])],
    query: Annotated[FigureQuery, Query()],
) -> Answer:
    """Return a figure as sentences and as a table, with the studies of every mark.

    CSV: a row per mark.
    """
    return Answer.of(service.figure(known, figure, query))
