"""/healthz, /metrics and /openapi.json: what the service says of itself."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import JSONResponse

from api.schema.service import Health
from api.service import metadata as service
from api.web.answers import StrictRoute
from api.web.dependencies import NO_PARAMETERS, Known
from api.web.negotiation import JSON, media_type
from api.web.observation import exposition

EXPOSITION = "text/plain; version=0.0.4; charset=utf-8"

router = APIRouter(route_class=StrictRoute, dependencies=[NO_PARAMETERS])


@router.get("/healthz", summary="Status of the service", response_model=Health)
async def health(request: Request, response: Response, known: Known) -> dict[str, Any]:
    """Return the status of the service, with versions of facts and record (digests of manifests).

    Never cached.
    """
    media_type(request.headers.get("accept"), (JSON,))
    response.headers["Cache-Control"] = "no-store"
    return service.health(known, request.app.version)


@router.get("/openapi.json", include_in_schema=False)
async def openapi(request: Request) -> Response:
    """Give the description of the service."""
    return JSONResponse(request.app.openapi())


@router.get("/metrics", include_in_schema=False)
def metrics() -> Response:
    """Give counts and times of requests to Prometheus (its text format)."""
    headers = {"Cache-Control": "no-store"}
    return Response(exposition(), headers=headers, media_type=EXPOSITION)
