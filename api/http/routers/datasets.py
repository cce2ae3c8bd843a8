"""/v1/datasets: what is measured on."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from api import columns
from api.http.answers import Answer, AnswerRoute, Picture, listing
from api.http.dependencies import AS_ACCEPTED, NO_PARAMETERS, Known, TableOnly
from api.http.models.base import Selected
from api.http.models.datasets import DatasetDetail, Datasets, DatasetsQuery
from api.http.models.words import DatasetName
from api.http.pagination import ordered, page

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)

Name = Annotated[
    DatasetName, Path(description="Name of the data set.", examples=["cmos-single-aperture"])
]


@router.get("/datasets", summary="The standard data sets", response_model=Datasets | Selected)
async def datasets(known: Known, query: Annotated[DatasetsQuery, Query()]) -> Answer:
    """Short cards of the simulated data sets every pipeline is scored on."""
    cards = ordered(known.measurements.cards, query.sort)
    shown = page(cards, "/v1/datasets", query)
    return listing(shown, shown.items, columns.DATASETS, fields=query.fields)


@router.get(
    "/datasets/{name}",
    summary="One data set",
    response_model=DatasetDetail,
)
async def dataset(
    known: Known,
    name: Name,
    query: TableOnly = AS_ACCEPTED,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Its card: all that its numbers depend on, and what is published of them.

    That is geometry, conditions with every parameter, seeds, the bound of each condition, the hash
    of each split, and where its picture is. As CSV: the hashes and bounds.
    """
    card = known.measurements.card(name)
    return Answer(card, columns.DATASET, lambda: card["data"])


@router.get(
    "/datasets/{name}/preview.png",
    summary="A picture of a data set",
    response_class=Picture,
    dependencies=[NO_PARAMETERS],
)
def dataset_preview(known: Known, name: Name) -> Picture:
    """Picture of some of its nominal samples.

    They are frames from small to large incidence, profiles, currents over angle or time, or spikes
    by their time. Where it is not drawn yet, who asks for it waits, and nobody else.
    """
    return Picture(known.pictures.png(name))
