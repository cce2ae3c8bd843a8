"""The HTTP service: facts, implementations and measurements as JSON and CSV, and the page.

`create_app` puts it together; `sunatlas serve` runs it.
"""

from __future__ import annotations

import gc
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from fastapi import FastAPI, Request, Response
from pydantic_core import to_json

from api.http import middleware, page, problems
from api.http.answers import Answers
from api.http.endpoints import all_endpoints, health, previews
from api.http.knowledge import Knowledge
from api.http.negotiation import JSON
from api.http.openapi import describe
from api.http.parameters import Parameters
from api.http.representations import Representation

DESCRIPTION = (
    "Which sun sensor to build and how to calibrate it: the literature as data, its algorithms "
    "as code, and both measured against the physical limit. Lists are paged (`limit`, `cursor`, "
    "`Link`), tables come as CSV for `Accept: text/csv`, every answer has a strong `ETag`, and "
    "every refusal is a problem document (RFC 9457) that names the nearest valid word."
)


def create_app(knowledge: Knowledge | None = None) -> FastAPI:
    """Return the service as an ASGI application.

    Facts are loaded once: at start-up where the server runs the lifespan, else at the first
    request that needs them.

    Parameters
    ----------
    knowledge : what is told; the survey and the published measurements by default
    """
    known = Knowledge() if knowledge is None else knowledge

    @asynccontextmanager
    async def lifespan(_app: FastAPI) -> AsyncIterator[None]:
        known.load_all()
        # What is loaded now stays: the collector need not walk it again for every few answers.
        gc.collect()
        gc.freeze()
        yield
        gc.unfreeze()

    app = FastAPI(
        title="Sun Sensor Atlas",
        version=_version(),
        description=DESCRIPTION,
        openapi_url=None,  # served below, with its ETag
        docs_url=None,  # would load scripts from elsewhere
        redoc_url=None,
        redirect_slashes=False,
        lifespan=lifespan,
    )
    endpoints = all_endpoints(known)
    answers = Answers()
    for endpoint in endpoints:
        endpoint.install(app, answers)
    drawn = previews.pictures(known)
    for picture in drawn:
        picture.install(app, answers)
    health.install(app, known)
    page.install(app)

    documents: list[Representation] = []

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = describe(app, endpoints, drawn)
        return app.openapi_schema

    async def openapi_json(request: Request) -> Response:
        Parameters().from_query(request.scope["query_string"])
        if not documents:
            body = to_json(app.openapi())
            documents.append(Representation(body, JSON, {"Vary": "Accept-Encoding"}))
        return documents[0].respond(request)

    app.openapi = openapi  # type: ignore[method-assign]  # FastAPI's documented way to extend it
    app.add_api_route("/openapi.json", openapi_json, include_in_schema=False)
    problems.install(app)
    app.add_middleware(middleware.EveryResponse)
    return app


def _version() -> str:
    """Return the version of the installed distribution; what says so where it runs uninstalled."""
    try:
        return version("sun-sensor-atlas")
    except PackageNotFoundError:
        return "0+uninstalled"
