"""What path functions share."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Query, Request

from api.schema.base import NoParameters, OnlyFormat
from api.service.knowledge import Knowledge
from api.web.negotiation import JSON, media_type


async def knowledge(request: Request) -> Knowledge:
    """Return what the application tells."""
    known: Knowledge = request.app.state.knowledge
    return known


async def json_accepted(request: Request) -> None:
    """Refuse a client that does not take JSON."""
    media_type(request.headers.get("accept"), (JSON,))


async def no_parameters(_query: Annotated[NoParameters, Query()]) -> None:
    """Refuse any query."""


Known = Annotated[Knowledge, Depends(knowledge)]
JSON_ONLY = Depends(json_accepted)
NO_PARAMETERS = Depends(no_parameters)
TableOnly = Annotated[OnlyFormat, Query()]
