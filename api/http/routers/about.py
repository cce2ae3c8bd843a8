"""/healthz, /metrics, /openapi.json and /docs: what the service says of itself."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response
from pydantic_core import to_json

from api.http.reference import reference
from api.schema.service import Health
from api.service import metadata as service
from api.web.answers import StrictRoute
from api.web.dependencies import JSON_ONLY, NO_PARAMETERS, Known
from api.web.negotiation import JSON
from api.web.observation import exposition
from api.web.representations import Representation, RepresentationCache

EXPOSITION = "text/plain; version=0.0.4; charset=utf-8"

router = APIRouter(route_class=StrictRoute, dependencies=[NO_PARAMETERS])


@router.get(
    "/healthz", summary="Status of the service", response_model=Health, dependencies=[JSON_ONLY]
)
async def health(request: Request, response: Response, known: Known) -> dict[str, Any]:
    """Return the status of the service, with versions of facts and record (digests of manifests).

    Never cached.
    """
    response.headers["Cache-Control"] = "no-store"
    return service.health(known, request.app.version)


@router.get("/openapi.json", include_in_schema=False)
def openapi(request: Request) -> Response:
    """Give FastAPI's description of the service with an ETag, which it does not give itself."""
    kept: RepresentationCache = request.app.state.kept
    found = kept.get("openapi")
    if found is None:
        found = Representation(to_json(request.app.openapi()), JSON, {"Vary": "Accept-Encoding"})
        kept.put("openapi", found)
    return found.respond(request)


@router.get("/docs", include_in_schema=False)
def docs(request: Request) -> Response:
    """Give the API reference."""
    kept: RepresentationCache = request.app.state.kept
    found = kept.get("docs")
    if found is None:
        text = reference(request.app.openapi())
        vary = {"Vary": "Accept-Encoding"}
        found = Representation(text.encode(), "text/html; charset=utf-8", vary)
        kept.put("docs", found)
    return found.respond(request)


@router.get("/metrics", include_in_schema=False)
def metrics() -> Response:
    """Give counts and times of requests to Prometheus (its text format)."""
    headers = {"Cache-Control": "no-store"}
    return Response(exposition(), headers=headers, media_type=EXPOSITION)
