"""/v1/datasets: the standard data sets."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query, Response

from api.schema.base import Selected
from api.schema.datasets import DatasetDetail, Datasets, DatasetsQuery
from api.schema.samples import SampleErrors, SampleErrorsQuery
from api.schema.words import DatasetName
from api.service import datasets as service
from api.web.answers import Answer, AnswerRoute, Columns, Picture, link
from api.web.dependencies import NO_PARAMETERS, Known, TableOnly

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)

Name = Annotated[
    DatasetName, Path(description="Name of the data set.", examples=["cmos-single-aperture"])
]


@router.get("/datasets", summary="Data sets", response_model=Datasets | Selected)
async def datasets(known: Known, query: Annotated[DatasetsQuery, Query()]) -> Answer:
    """List the simulated data sets."""
    return Answer.of(service.datasets(known, query))


@router.get(
    "/datasets/{name}",
    summary="A data set",
    response_model=DatasetDetail,
)
async def dataset(
    known: Known,
    name: Name,
    query: TableOnly,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Return the description of a data set and its published hashes and bounds.

    Geometry, conditions with all parameters, seeds, bounds, hashes, address of the picture. CSV:
    hashes and bounds.
    """
    return Answer.of(service.dataset(known, name))


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
    return Answer.of(service.errors(known, name, query))


@router.get(
    "/datasets/{name}/errors.parquet",
    summary="Errors of each sample, as a file",
    response_class=Columns,
    dependencies=[NO_PARAMETERS],
)
def errors_file(known: Known, name: Name) -> Response:
    """Return the published errors of all samples as Parquet.

    Columns: extractor, model, unit, sample, error_deg (NaN: no answer) and outcome.
    """
    return _file(known, name, "errors")


@router.get(
    "/datasets/{name}/directions.parquet",
    summary="Directions of the samples, as a file",
    response_class=Columns,
    dependencies=[NO_PARAMETERS],
)
def directions_file(known: Known, name: Name) -> Response:
    """Return the published directions of the test samples as Parquet, to join with the errors.

    Columns: sample, sun_x, sun_y, sun_z, observable and bound_deg (NaN: none).
    """
    return _file(known, name, "directions")


def _file(known: Known, name: str, kind: str) -> Response:
    content = service.file(known, name, kind)
    saved = {"Content-Disposition": f'attachment; filename="{name}.{kind}.parquet"'}
    return link(Columns(content, headers=saved), *service.links_of(known, name))
