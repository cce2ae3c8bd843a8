"""The HTTP service: facts, implementations and measurements as JSON and CSV, and the page.

`create_app` puts it together; `sunatlas serve` runs it.
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from fastapi import FastAPI
from fastapi.routing import APIRoute
from starlette.middleware.gzip import DEFAULT_EXCLUDED_CONTENT_TYPES, GZipMiddleware

from api.http import about, calibrations, files, metadata, tables
from api.http.openapi import describe
from api.metadata.identity import version
from api.pages.routers import ROUTERS as PAGES
from api.server import handlers
from api.server.kept import KeptAnswers
from api.server.prefix import UnderPrefix
from api.service.knowledge import Knowledge
from api.web.asking import visit_start_page
from api.web.middleware import EveryResponse
from api.web.negotiation import PARQUET

DESCRIPTION = (
    "Which sun sensor to build and how to calibrate it: published studies, their algorithms, and "
    "measurements against the physical limit. Read-only, no authentication. Lists are paged "
    "(`limit`, `cursor`, `Link`). `format=csv` or `Accept: text/csv` returns tables as CSV; "
    "`safe=true` escapes cells that a spreadsheet would run as formulas. Every response has a "
    "strong `ETag`. Errors are problem documents (RFC 9457) with the nearest valid value. In CSV "
    "an empty cell is an unknown value, and `none stated` is the survey's value `None`."
)
ROUTERS = (
    metadata.router,  # before what takes its words for names of data sets
    metadata.root,
    tables.router,
    files.router,
    calibrations.router,
    about.router,
    files.static,
    *PAGES,
)
ROUTES = [route for router in ROUTERS for route in router.routes if isinstance(route, APIRoute)]


def create_app(knowledge: Knowledge | None = None) -> FastAPI:
    """Return the service as an ASGI application.

    Facts are loaded once: at start-up where the server runs the lifespan, else at the first
    request that needs them.

    Parameters
    ----------
    knowledge : facts and measurements; the survey and the published measurements by default
    """
    app = FastAPI(
        title="Sun Sensor Atlas",
        version=version(),
        description=DESCRIPTION,
        openapi_url=None,  # served by a router, as /docs is, which loads no script from elsewhere
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        lifespan=_lifespan,
        generate_unique_id_function=lambda route: route.name,
    )
    app.state.knowledge = Knowledge() if knowledge is None else knowledge
    for router in ROUTERS:
        app.include_router(router)
    handlers.install(app, ROUTES)
    app.add_middleware(UnderPrefix)
    packed = (*DEFAULT_EXCLUDED_CONTENT_TYPES, PARQUET)
    app.add_middleware(
        GZipMiddleware, minimum_size=512, compresslevel=6, exclude_content_types=packed
    )
    app.add_middleware(KeptAnswers)
    app.add_middleware(EveryResponse)

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = describe(app, ROUTES)
        return app.openapi_schema

    app.openapi = openapi  # type: ignore[method-assign]  # FastAPI's documented way to extend it
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    app.state.knowledge.load_all()
    app.openapi()  # now, as it holds up every answer meanwhile
    visit = asyncio.create_task(visit_start_page(app))
    yield
    visit.cancel()
