"""/directions: the survey's future directions, each with a rule and a verdict."""

from __future__ import annotations

from typing import Annotated

from api.pages.serving import PageRouter, View
from api.service import directions as service
from api.web.dependencies import NO_PARAMETERS, Known

router = PageRouter()


@router.page("/directions")
async def directions(known: Known, _asked: Annotated[None, NO_PARAMETERS] = None) -> View:
    """List the directions with their verdicts."""
    return View("directions.html", service.directions(known))
