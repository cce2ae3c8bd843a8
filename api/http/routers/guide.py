"""The guide: a site of static pages."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from api.http.guide import respond
from api.web.answers import StrictRoute

router = APIRouter(route_class=StrictRoute, include_in_schema=False)


@router.get("/guide")
async def to_index(request: Request) -> Response:
    """Send on to the address that the guide's relative links hold from."""
    query = f"?{request.url.query}" if request.url.query else ""
    return Response(status_code=308, headers={"Location": f"/guide/{query}"})


@router.get("/guide/{name:path}")
def static(name: str) -> Response:
    """Give a file of the guide; what stands in its query is for its scripts."""
    return respond(name)
