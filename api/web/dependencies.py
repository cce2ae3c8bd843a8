"""What path functions share."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Query, Request

from api.schema.base import NoParameters
from api.service.knowledge import Knowledge


async def knowledge(request: Request) -> Knowledge:
    """Return what the application tells."""
    known: Knowledge = request.app.state.knowledge
    return known


async def no_parameters(_query: Annotated[NoParameters, Query()]) -> None:
    """Refuse any query."""


Known = Annotated[Knowledge, Depends(knowledge)]
NO_PARAMETERS = Depends(no_parameters)
