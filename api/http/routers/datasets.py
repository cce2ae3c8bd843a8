"""/v1/datasets: the standard data sets."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from api.metadata.identity import identity
from api.metadata.signposting import headers, landing_of_dataset
from api.schema.base import Selected
from api.schema.datasets import Data, Dataset, DatasetDetail, Datasets, DatasetsQuery
from api.schema.samples import SampleError, SampleErrors, SampleErrorsQuery
from api.schema.table import columns_of
from api.schema.words import DatasetName
from api.service.pagination import order, page
from api.service.problems import Problem
from api.service.sample_errors import choose, rows_of
from api.web.answers import Answer, AnswerRoute, Columns, Picture, list_answer
from api.web.dependencies import AS_ACCEPTED, NO_PARAMETERS, Known, TableOnly
from benchmark.results import samples

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)

Name = Annotated[
    DatasetName, Path(description="Name of the data set.", examples=["cmos-single-aperture"])
]


@router.get("/datasets", summary="Data sets", response_model=Datasets | Selected)
async def datasets(known: Known, query: Annotated[DatasetsQuery, Query()]) -> Answer:
    """List the simulated data sets."""
    cards = order(known.measurements.cards, query.sort)
    shown = page(cards, "/v1/datasets", query)
    return list_answer(shown, shown.items, columns_of(Dataset), fields=query.fields)


@router.get(
    "/datasets/{name}",
    summary="A data set",
    response_model=DatasetDetail,
)
async def dataset(
    known: Known,
    name: Name,
    query: TableOnly = AS_ACCEPTED,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Return the description of a data set and its published hashes and bounds.

    Geometry, conditions with all parameters, seeds, bounds, hashes, address of the picture. CSV:
    hashes and bounds.
    """
    card = known.measurements.card(name)
    link = ", ".join(_links(known, name))
    return Answer(card, columns_of(Data), lambda: card["data"], link)


@router.get(
    "/datasets/{name}/preview.png",
    summary="Picture of a data set",
    response_class=Picture,
    dependencies=[NO_PARAMETERS],
)
def dataset_preview(known: Known, name: Name) -> Picture:
    """Return a picture of nominal samples.

    Frames, profiles, currents or events. The first request draws the picture and may take seconds.
    """
    return Picture(known.pictures.png(name))


@router.get(
    "/datasets/{name}/errors",
    summary="Errors of each sample",
    response_model=SampleErrors | Selected,
)
async def errors(known: Known, name: Name, query: Annotated[SampleErrorsQuery, Query()]) -> Answer:
    """Return the error of every pipeline on every test sample, nominal condition.

    By extractor, model, unit and sample, with direction and bound. The whole table is
    /v1/datasets/{name}/errors.parquet.
    """
    found = choose(known.measurements, name, query)
    shown = page(range(len(found)), f"/v1/datasets/{name}/errors", query)
    items = rows_of(found.iloc[list(shown.items)])
    return list_answer(shown, items, columns_of(SampleError), fields=query.fields)


@router.get(
    "/datasets/{name}/errors.parquet",
    summary="Errors of each sample, as a file",
    response_class=Columns,
    dependencies=[NO_PARAMETERS],
)
def errors_file(known: Known, name: Name) -> Columns:
    """Return the published errors of all samples as Parquet.

    Columns: extractor, model, unit, sample, error_deg (NaN: no answer) and outcome.
    """
    return _file(known, samples.path_of(name), f"{name}.errors.parquet")


@router.get(
    "/datasets/{name}/directions.parquet",
    summary="Directions of the samples, as a file",
    response_class=Columns,
    dependencies=[NO_PARAMETERS],
)
def directions_file(known: Known, name: Name) -> Columns:
    """Return the published directions of the test samples as Parquet, to join with the errors.

    Columns: sample, sun_x, sun_y, sun_z, observable and bound_deg (NaN: none).
    """
    path = samples.path_of(name, directions=True)
    return _file(known, path, f"{name}.directions.parquet")


def _file(known: Known, path: str, name: str) -> Columns:
    try:
        return Columns(known.measurements.file(path), name, _links(known, name.partition(".")[0]))
    except FileNotFoundError:
        raise Problem(404, "not-published", f"no {name} is published") from None


def _links(known: Known, name: str) -> tuple[str, ...]:
    """Return the links of a data set's content (Signposting)."""
    sampled = samples.has_samples(name, known.measurements.directory)
    landing = landing_of_dataset(name, identity(), sampled=sampled)
    return headers(landing.links_of_content())
