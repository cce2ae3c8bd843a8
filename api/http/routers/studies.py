"""/v1/studies: the studies and their implementation."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from api.schema.base import Selected
from api.schema.studies import (
    Editions,
    Studies,
    StudiesQuery,
    StudyDetail,
    StudyQuery,
)
from api.schema.words import StudyKey
from api.service import studies as service
from api.web.answers import Answer, AnswerRoute, CitedAnswer
from api.web.dependencies import Known, TableOnly

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get(
    "/studies",
    summary="Studies",
    response_model=Studies | Selected,
    response_class=CitedAnswer,
)
async def studies(known: Known, query: Annotated[StudiesQuery, Query()]) -> Answer:
    """List the studies of the survey: 129 keys in its tables, 128 in its text.

    `edition=all` includes added studies. BibTeX, RIS and CSL JSON: references to studies with a
    known title.
    """
    found = service.studies(known, query)
    return CitedAnswer(found, found.document["items"], narrowed=bool(query.fields))


@router.get("/editions", summary="Editions of the studies", response_model=Editions)
async def editions(
    known: Known,
    query: TableOnly,  # noqa: ARG001 - the route has read it
) -> Answer:
    """List the editions of the studies, for citation.

    A version consists of the data package's version, the number of studies and a digest of their
    tables.
    """
    return Answer.of(service.editions(known))


@router.get(
    "/studies/{key}",
    summary="A study",
    response_model=StudyDetail,
    response_class=CitedAnswer,
)
async def study(
    known: Known,
    key: Annotated[StudyKey, Path(description="Key of the study.", examples=["Chang2008"])],
    query: Annotated[StudyQuery, Query()],  # noqa: ARG001 - the route has read it
) -> Answer:
    """Return a study: values with basis, implementation and scores.

    Pipelines implement the study's method or the nearest one; values that are not implemented are
    listed as gaps. CSV: the values. BibTeX, RIS, CSL JSON: the reference.
    """
    found = service.study(known, key)
    return CitedAnswer(found, [found.document], key)
