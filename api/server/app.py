"""The HTTP service: facts, implementations and measurements as JSON and CSV, and the page.

`create_app` puts it together; `sunatlas serve` runs it.
"""

from __future__ import annotations

import asyncio
import gc
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from fastapi import FastAPI
from fastapi.routing import APIRoute

from api.http.openapi import describe
from api.http.routers import ROUTERS as SERVICE
from api.http.routers import recommendations
from api.pages.routers import ROUTERS as PAGES
from api.server import handlers
from api.service.knowledge import Knowledge
from api.web import middleware
from api.web.representations import RepresentationCache

DESCRIPTION = (
    "Which sun sensor to build and how to calibrate it: published studies, their algorithms, and "
    "measurements against the physical limit. Read-only, no authentication. Lists are paged "
    "(`limit`, `cursor`, `Link`). `format=csv` or `Accept: text/csv` returns tables as CSV; "
    "`safe=true` escapes cells that a spreadsheet would run as formulas. Every response has a "
    "strong `ETag`. Errors are problem documents (RFC 9457) with the nearest valid value. In CSV "
    "an empty cell is an unknown value, and `none stated` is the survey's value `None`."
)
#: New objects after which the collector runs: an answer makes thousands, few of them in cycles.
COLLECTED_AFTER = 20_000
ROUTERS = (*SERVICE, *PAGES)
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
        version=_version(),
        description=DESCRIPTION,
        openapi_url=None,  # served by a router, with its ETag
        docs_url=None,  # would load scripts from elsewhere
        redoc_url=None,
        redirect_slashes=False,
        lifespan=_lifespan,
        generate_unique_id_function=lambda route: route.name,
    )
    app.state.knowledge = Knowledge() if knowledge is None else knowledge
    app.state.kept = RepresentationCache()
    # Routes are tried one after another: first what is asked most, and is to be answered at once.
    for router in sorted(ROUTERS, key=lambda one: one is not recommendations.router):
        app.include_router(router)
    handlers.install(app, ROUTES)
    app.add_middleware(middleware.EveryResponse)

    describing = threading.Lock()  # FastAPI's part of it is not for two threads at once

    def openapi() -> dict[str, Any]:
        with describing:
            if app.openapi_schema is None:
                app.openapi_schema = describe(app, ROUTES)
            return app.openapi_schema

    app.openapi = openapi  # type: ignore[method-assign]  # FastAPI's documented way to extend it
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    before = gc.get_threshold()
    gc.set_threshold(COLLECTED_AFTER)
    app.state.knowledge.load_all()
    # Who asks for it first shall not wait for it, nor shall all others meanwhile: a thread beside
    # them would hold up each of their answers. Before a service answers it is nobody's loss.
    await asyncio.to_thread(app.openapi)  # it asks path functions, each in a loop of its own
    # What is loaded now stays: the collector need not walk it again for every few answers.
    gc.collect()
    gc.freeze()
    yield
    gc.unfreeze()
    gc.set_threshold(*before)


def _version() -> str:
    """Return the version of the installed distribution; what says so where it runs uninstalled."""
    try:
        return version("sun-sensor-atlas")
    except PackageNotFoundError:
        return "0+uninstalled"
