"""Croissant metadata and link sets of data sets and leaderboard, and codemeta.json."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from fastapi import APIRouter, Path, Request

from api.http.routers.datasets import dataset
from api.http.routers.leaderboard import leaderboard
from api.metadata import served, signposting
from api.metadata.codemeta import codemeta
from api.metadata.croissant import croissant
from api.metadata.identity import identity
from api.metadata.terms import LD_JSON, LINKSET
from api.schema.scores import WholeLeaderboardQuery
from api.schema.words import DatasetName
from api.service.knowledge import Knowledge
from api.web.answers import AnswerRoute, LinkDocument
from api.web.dependencies import NO_PARAMETERS, Known
from api.web.negotiation import CSV
from benchmark.results import samples

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
async def dataset_croissant(request: Request, known: Known, name: Name) -> LinkedData:
    """Files with SHA-256 and column descriptions (MLCommons Croissant 1.0).

    Load records with `mlcroissant.Dataset(jsonld=ADDRESS)`.
    """
    base, who = str(request.base_url), identity()
    answer = await dataset(known, name)
    file, table = served.table_of_data(answer.representation(CSV).body, name, base)
    files, tables = [file], [table]
    published = _samples(known, name)
    if published:
        found = served.files_of_samples(name, {k: make() for k, make in published.items()}, base)
        files = [*found, file]
        tables = [*served.tables_of_samples(*(one.name for one in found)), table]
    document = croissant(served.of_dataset(known.measurements.card(name), base), who, files, tables)
    landing = landing_of_dataset(known, name)
    return LinkedData(document, signposting.headers(landing.links_of_metadata()))


@router.get(
    "/datasets/{name}/linkset.json",
    summary="Links of a data set's page",
    response_class=LinkSet,
)
async def dataset_linkset(request: Request, known: Known, name: Name) -> LinkSet:
    """All typed links of its page, content and metadata (Signposting, RFC 9264)."""
    return LinkSet(landing_of_dataset(known, name).link_set(str(request.base_url)))


@router.get(
    "/leaderboard/croissant.json",
    summary="Croissant metadata of the leaderboard",
    response_class=LinkedData,
)
async def leaderboard_croissant(request: Request, known: Known) -> LinkedData:
    """Return the table of the leaderboard with SHA-256 and column descriptions."""
    base, who = str(request.base_url), identity()
    answer = await leaderboard(known, WholeLeaderboardQuery.model_validate({"whole": True}))
    file, table = served.table_of_ranks(answer.representation(CSV).body, base)
    document = croissant(served.of_record(who, base), who, [file], [table])
    landing = signposting.landing_of_record(who)
    return LinkedData(document, signposting.headers(landing.links_of_metadata()))


@router.get(
    "/leaderboard/linkset.json",
    summary="Links of the leaderboard's page",
    response_class=LinkSet,
)
async def leaderboard_linkset(request: Request) -> LinkSet:
    """All typed links of its page, content and metadata (Signposting, RFC 9264)."""
    return LinkSet(signposting.landing_of_record(identity()).link_set(str(request.base_url)))


@root.get("/codemeta.json", response_class=LinkedData)
async def software() -> LinkedData:
    """Return the description of the software (CodeMeta 3.0)."""
    landing = signposting.landing_of_atlas(identity())
    links = signposting.headers(landing.links_of_metadata())
    return LinkedData(codemeta(identity().citation), links)


def landing_of_dataset(known: Knowledge, name: str) -> signposting.LandingPage:
    """Return the page of a data set, with the files that are published of it."""
    return signposting.landing_of_dataset(name, identity(), sampled=bool(_samples(known, name)))


def _samples(known: Knowledge, name: str) -> dict[str, Callable[[], bytes]]:
    """Return what reads the errors and directions of a data set; nothing where none are there."""
    if not samples.has_samples(name, known.measurements.directory):
        return {}
    return {
        "errors": lambda: known.measurements.file(samples.path_of(name)),
        "directions": lambda: known.measurements.file(samples.path_of(name, directions=True)),
    }
