"""/v1/datasets: what is measured on."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from api.http.answers import Answer, AnswerRoute, Picture, listing
from api.http.dependencies import NO_PARAMETERS, Known
from api.http.models.datasets import DatasetDetail, Datasets, DatasetsQuery
from api.http.models.words import DatasetName
from api.http.pagination import page

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)

COLUMNS = ("name", "version", "detector", "mask", "observation", "conditions")
DATA_COLUMNS = ("condition", "split", "samples", "data_hash", "bound_deg")

Name = Annotated[
    DatasetName, Path(description="Name of the data set.", examples=["cmos-single-aperture"])
]


@router.get("/datasets", summary="The standard data sets", response_model=Datasets)
async def datasets(known: Known, query: Annotated[DatasetsQuery, Query()]) -> Answer:
    """Short cards of the simulated data sets every pipeline is scored on."""
    shown = page(known.measurements.cards, "/v1/datasets", query)
    return listing(shown, shown.items, COLUMNS)


@router.get(
    "/datasets/{name}",
    summary="One data set",
    response_model=DatasetDetail,
    dependencies=[NO_PARAMETERS],
)
async def dataset(known: Known, name: Name) -> Answer:
    """Its card: all that its numbers depend on, and what is published of them.

    That is geometry, conditions with every parameter, seeds, the bound of each condition, the hash
    of each split, and where its picture is. As CSV: the hashes and bounds.
    """
    card = known.measurements.card(name)
    return Answer(card, DATA_COLUMNS, lambda: card["data"])


@router.get(
    "/datasets/{name}/preview.png",
    summary="A picture of a data set",
    response_class=Picture,
    dependencies=[NO_PARAMETERS],
)
def dataset_preview(known: Known, name: Name) -> Picture:
    """Picture of some of its nominal samples.

    They are frames from small to large incidence, profiles, currents over angle or time, or spikes
    by their time.
    """
    from benchmark.datasets.preview import preview_png  # noqa: PLC0415 - renders, so on demand

    return Picture(preview_png(known.measurements.presets[name]))
