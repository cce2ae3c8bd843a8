"""Files as they are: pictures and tables of data sets, the pages' own, and those of the guide."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request, Response
from starlette.staticfiles import StaticFiles

from api.guide import site
from api.previews import png
from api.schema.words import DatasetName
from api.service import datasets as service
from api.web.answers import AnswerRoute, Columns, Picture, StrictRoute, link
from api.web.dependencies import NO_PARAMETERS, Known
from api.web.static_files import PAGE, file_of, kept, page_address, styles

router = APIRouter(prefix="/v1/datasets", route_class=AnswerRoute, dependencies=[NO_PARAMETERS])
static = APIRouter(route_class=StrictRoute, include_in_schema=False)

Name = Annotated[
    DatasetName, Path(description="Name of the data set.", examples=["cmos-single-aperture"])
]
_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width"></head><body><h1>{title}</h1>
<p>{said}</p></body></html>
"""
_UNBUILT = _PAGE.format(
    title="The guide is not built",
    said="Run <code>sunatlas guide build</code>, which takes half a minute, then load this page "
    'again; <a href="/">the atlas</a> is there meanwhile.',
)
_MISSING = _PAGE.format(
    title="The guide is not installed",
    said=f"What builds it is an extra: <code>{site.INSTALL}</code>, then "
    '<code>sunatlas guide build</code>. <a href="/">The atlas</a> does without it.',
)


@router.get("/{name}/preview.png", summary="Picture of a data set", response_class=Picture)
def dataset_preview(name: Name) -> Picture:
    """Return a picture of nominal samples.

    Frames, profiles, currents or events.
    """
    return Picture(png(name))


@router.get(
    "/{name}/errors.parquet", summary="Errors of each sample, as a file", response_class=Columns
)
def errors_file(known: Known, name: Name) -> Response:
    """Return the published errors of all samples as Parquet.

    Columns: extractor, model, unit, sample, error_deg (NaN: no answer) and outcome.
    """
    return _file(known, name, "errors")


@router.get(
    "/{name}/directions.parquet",
    summary="Directions of the samples, as a file",
    response_class=Columns,
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


@static.get("/page/{name:path}", dependencies=[NO_PARAMETERS])
def page_file(name: str) -> Response:
    """Give a file of the page, by its name or below `page_address`."""
    plain = f"/page/{name}".removeprefix(f"{page_address()}/")
    if plain == f"/page/{name}":
        return file_of(PAGE, name, "page")
    if plain == "styles.css":
        return kept(Response(styles(), media_type="text/css"))
    return kept(file_of(PAGE, plain, "page"))


@static.get("/guide")
async def to_guide(request: Request) -> Response:
    """Send on to the address that the guide's relative links hold from."""
    query = f"?{request.url.query}" if request.url.query else ""
    return Response(status_code=308, headers={"Location": f"/guide/{query}"})


@static.get("/guide/{name:path}")
def guide_file(name: str) -> Response:
    """Give a file of the guide; where it is not built, a page that says how (503).

    What stands in its query is for its scripts.
    """
    place = site.cached_site()
    if place is None or not place.is_dir():
        text = _MISSING if place is None else _UNBUILT
        return Response(text, 503, headers={"Cache-Control": "no-store"}, media_type="text/html")
    return file_of(StaticFiles(directory=place), name or "index.html", "guide")
