"""/calibrate: a form that takes a turntable file, and the report that comes of it."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from api.calibrate.uploaded import LARGEST, LONGEST_S, MOST_ROWS
from api.pages.rendering import render
from api.pages.serving import page_bytes, refusal_page
from api.service.problems import Problem
from api.web.answers import StrictRoute
from api.web.calibrations import HTML, calibrated

router = APIRouter(route_class=StrictRoute, include_in_schema=False)


@router.get("/calibrate")
async def form(request: Request) -> Response:
    """Give the form; `model` in the query is filled in."""
    context = {"path": "/calibrate", "query": "", "megabytes": LARGEST // 1_000_000}
    page = render(
        "calibrate/form.html",
        {
            **context,
            "rows": MOST_ROWS,
            "seconds": int(LONGEST_S),
            "model": request.query_params.get("model", ""),
        },
    )
    return page_bytes(page).respond(request)


@router.post("/calibrate")
async def report(request: Request) -> Response:
    """Give the report of a calibration, or a page that says why there is none."""
    try:
        return await calibrated(request, HTML)
    except Problem as problem:
        return refusal_page(request, problem)
