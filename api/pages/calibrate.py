"""/calibrate: a form that takes a turntable file, with the report that comes of it below."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping
from typing import Any, get_args

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse
from markupsafe import Markup

from api.pages.rendering import render
from api.service import calibrations as service
from api.service.problems import Problem
from api.web.answers import StrictRoute
from api.web.calibrations import ANSWERS, HTML, as_response, sent, while_there
from calibrate.forms.units import AngleUnit, TemperatureUnit, TimeUnit
from calibrate.sample import NAME, sample
from calibrate.settings import Form, Kind
from calibrate.uploaded import LARGEST, LONGEST_S, MOST_ROWS, Upload

#: Kinds of readings and forms of directions as the form calls them.
_KINDS = {
    "spot": "x and y of a spot",
    "balance": "two balances, -1 to 1",
    "pair": "two readings of one axis",
    "quadrants": "four quadrants: -x +y, +x +y, +x -y, -x -y",
    "electrodes": "four electrodes: x+, x-, y+, y-",
    "channels": "a channel per photodiode",
}
_FORMS = {
    "vector": "unit vector x, y, z",
    "projection": "projection angles alpha, beta",
    "alpha-inner": "turntable: axis 1 next to the sensor",
    "beta-inner": "turntable: axis 2 next to the sensor",
    "azimuth-elevation": "azimuth, elevation",
    "azimuth-zenith": "azimuth, off-axis angle",
    "one-angle": "one angle",
    "quaternion": "attitude as a quaternion",
    "matrix": "attitude as a matrix, nine columns",
}
router = APIRouter(route_class=StrictRoute, include_in_schema=False)

#: Fields that a form keeps.
_KEPT = ("config", "model", "require", "apply")
#: The field that a button sends instead of files.
_SAMPLE = "sample"


@router.get("/calibrate")
async def form(request: Request) -> Response:
    """Give the form; `model` in the query is filled in."""
    return _page({"model": request.query_params.get("model", "")})


@router.get(f"/calibrate/{NAME}")
def sample_file() -> Response:
    """Give the sample file."""
    return Response(sample(), media_type="text/csv")


@router.post("/calibrate")
async def report(request: Request) -> Response:
    """Give the form with the report below it, or beside it why there is none."""
    fields: Mapping[str, str] = {}
    try:
        fields, files = await sent(request)
        asked = {name: value for name, value in fields.items() if name != _SAMPLE}
        if _SAMPLE in fields:  # what was set up for another file does not fit this one
            asked, files = {**asked, "config": ""}, (Upload(NAME, sample()),)
        read = service.read(asked, files)
        made = await while_there(request, service.calibrated(read, files))
        wanted = ANSWERS.get(read.answer, HTML)
        if wanted != HTML:
            return as_response(made, wanted)
        shown, status = _page(fields, made=made), 200
    except Problem as problem:
        shown, status = _page(fields, problem=problem.document("/calibrate")), problem.status_code
    shown.status_code = status
    shown.headers["Cache-Control"] = "no-store"
    return shown


def _page(
    fields: Mapping[str, str],
    *,
    made: Mapping[str, str] | None = None,
    problem: Mapping[str, Any] | None = None,
) -> Response:
    choices = {
        "kinds": [(kind, _KINDS.get(kind, kind)) for kind in get_args(Kind) if kind != "frames"],
        "forms": [(form, _FORMS.get(form, form)) for form in get_args(Form)],
        "angle_units": [(unit, unit) for unit in get_args(AngleUnit)],
        "time_units": [(unit, unit) for unit in get_args(TimeUnit)],
        "temperature_units": [(unit, unit) for unit in get_args(TemperatureUnit)],
    }
    return HTMLResponse(
        render(
            "calibrate/form.html",
            {
                "path": "/calibrate",
                "query": "",
                "megabytes": LARGEST // 1_000_000,
                "rows": MOST_ROWS,
                "seconds": int(LONGEST_S),
                "fields": {name: fields.get(name, "") for name in _KEPT},
                "sample": NAME,
                "choices": choices,
                "problem": problem,
                "report": None if made is None else _shown(made),
            },
        )
    )


def _shown(made: Mapping[str, str]) -> dict[str, Any]:
    """Return a report in parts that a page takes up, and all files as an archive."""
    whole = next(text for name, text in made.items() if name.endswith("_report.html"))
    style = whole.partition("<style>")[2].partition("</style>")[0]
    article = whole.partition("<body>")[2].rpartition("</body>")[0]
    return {
        "style": Markup(style),  # noqa: S704 - of our own template
        "article": Markup(article),  # noqa: S704 - escaped by it
        "archive": "data:application/zip;base64," + b64encode(service.archive_of(made)).decode(),
        "page": "data:text/html;charset=utf-8;base64," + b64encode(whole.encode()).decode(),
        "files": list(made),
    }
