"""/docs: the API reference, made of the OpenAPI description by Swagger UI in the browser."""

from __future__ import annotations

from fastapi import APIRouter, Response
from fastapi.responses import HTMLResponse

from api.pages.rendering import render
from api.web.answers import StrictRoute
from api.web.dependencies import NO_PARAMETERS

router = APIRouter(route_class=StrictRoute, include_in_schema=False, dependencies=[NO_PARAMETERS])


@router.get("/docs")
def reference() -> Response:
    """Give the page; without a script it links the description."""
    return HTMLResponse(render("reference.html", {"path": "/docs", "query": ""}))
