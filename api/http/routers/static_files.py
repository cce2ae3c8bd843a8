"""Static files of the pages."""

from __future__ import annotations

from fastapi import APIRouter, Response

from api.web.answers import StrictRoute
from api.web.dependencies import NO_PARAMETERS
from api.web.static_files import PAGE, file_of

router = APIRouter(route_class=StrictRoute, include_in_schema=False)


@router.get("/page/{name:path}", dependencies=[NO_PARAMETERS])
def static(name: str) -> Response:
    """Give a file of the page."""
    return file_of(PAGE, name, "page")
