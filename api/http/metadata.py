"""Croissant metadata and link sets of data sets and leaderboard, and codemeta.json."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request, Response

from api.metadata import signposting
from api.metadata.identity import LD_JSON, LINKSET, identity
from api.schema.words import DatasetName
from api.service import metadata as service
from api.web.answers import AnswerRoute, LinkDocument, link
from api.web.dependencies import NO_PARAMETERS, Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, dependencies=[NO_PARAMETERS])
root = APIRouter(route_class=AnswerRoute, dependencies=[NO_PARAMETERS], include_in_schema=False)

Name = Annotated[
    DatasetName, Path(description="Name of the data set.", examples=["cmos-single-aperture"])
]


class LinkedData(LinkDocument):
    """A JSON-LD document."""

    media_type = LD_JSON


class LinkSet(LinkDocument):
    """A link set (RFC 9264)."""

    media_type = LINKSET


@router.get(
    "/datasets/{name}/croissant.json",
    summary="Croissant metadata of a data set",
    response_class=LinkedData,
)
async def dataset_croissant(request: Request, known: Known, name: Name) -> Response:
    """Files with SHA-256 and column descriptions (MLCommons Croissant 1.0).

    Load records with `mlcroissant.Dataset(jsonld=ADDRESS)`.
    """
    found = service.dataset_croissant(known, name, str(request.base_url))
    return link(LinkedData(found.document), *found.links)


@router.get(
    "/datasets/{name}/linkset.json", summary="Links of a data set's page", response_class=LinkSet
)
async def dataset_linkset(request: Request, known: Known, name: Name) -> LinkSet:
    """All typed links of its page, content and metadata (Signposting, RFC 9264)."""
    return LinkSet(service.landing_of_dataset(known, name).link_set(str(request.base_url)))


@router.get(
    "/leaderboard/croissant.json",
    summary="Croissant metadata of the leaderboard",
    response_class=LinkedData,
)
async def leaderboard_croissant(request: Request, known: Known) -> Response:
    """Return the table of the leaderboard with SHA-256 and column descriptions."""
    found = service.leaderboard_croissant(known, str(request.base_url))
    return link(LinkedData(found.document), *found.links)


@router.get(
    "/leaderboard/linkset.json", summary="Links of the leaderboard's page", response_class=LinkSet
)
async def leaderboard_linkset(request: Request) -> LinkSet:
    """All typed links of its page, content and metadata (Signposting, RFC 9264)."""
    return LinkSet(signposting.landing_of_record(identity()).link_set(str(request.base_url)))


@root.get("/codemeta.json", response_class=LinkedData)
async def software() -> Response:
    """Return the description of the software (CodeMeta 3.0)."""
    found = service.software()
    return link(LinkedData(found.document), *found.links)
