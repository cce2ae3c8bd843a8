"""/v1/calibrations: files of a turntable to a calibration, its report and its code."""

from __future__ import annotations

import asyncio
import io
import zipfile
from collections.abc import Mapping
from typing import Any

from fastapi import APIRouter, Request, Response

from api.calibrate.uploaded import UploadRefusedError, calibrate_uploads
from api.http.answers import StrictRoute
from api.http.dependencies import NO_PARAMETERS
from api.http.negotiation import JSON, media_type
from api.http.problems import Problem, Violation
from api.http.uploads import Form, read_form
from survey_data.nearest import nearest_name

HTML, ZIP = "text/html", "application/zip"
OFFERED = (JSON, HTML, ZIP)
#: What the field `answer` calls them.
ANSWERS: Mapping[str, str] = {"json": JSON, "report": HTML, "zip": ZIP}
_FIELDS = ("config", "model", "apply", "answer")
#: One calibration at a time in a process of the server: each keeps a core busy.
_BUSY = asyncio.Semaphore(1)
_RETRY_S = "30"

router = APIRouter(prefix="/v1", route_class=StrictRoute, dependencies=[NO_PARAMETERS])

_TEXT = {"type": "string"}
_BODY: dict[str, Any] = {
    "required": True,
    "content": {
        "multipart/form-data": {
            "schema": {
                "type": "object",
                "required": ["file"],
                "properties": {
                    "file": {
                        "type": "array",
                        "items": {"type": "string", "format": "binary"},
                        "description": "CSV, Parquet, NumPy or Excel; each a run of one sensor. "
                        "10 MB and 100,000 rows in all.",
                    },
                    "config": {
                        **_TEXT,
                        "description": "TOML, as `sunatlas calibrate --init` writes it; guessed "
                        "from the header by default.",
                    },
                    "model": {**_TEXT, "description": "The only model tried; all by default."},
                    "apply": {
                        **_TEXT,
                        "enum": ["true", "false"],
                        "description": "Whether conventions found with certainty are applied.",
                    },
                    "answer": {
                        **_TEXT,
                        "enum": list(ANSWERS),
                        "description": "Before `Accept`: calibration, report, or all files.",
                    },
                },
            },
            "example": {
                "file": ["x_px,y_px,theta_x_deg,theta_y_deg\n512.03,511.98,0.0,0.0\n"],
                "apply": "true",
                "answer": "json",
            },
        }
    },
}
_PROBLEM = {
    "application/problem+json": {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}
}
_RESPONSES: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The calibration as JSON, its report, or a ZIP of all files.",
        "content": {
            JSON: {
                "schema": {"type": "object"},
                "example": {
                    "schema": "sun-sensor-atlas/sensor-calibration",
                    "schema_version": 1,
                    "verdict": {"verdict": "good", "split_half_ratio": 1.02, "patterns": []},
                },
            },
            HTML: {"schema": _TEXT},
            ZIP: {"schema": {**_TEXT, "format": "binary"}},
        },
    },
    400: {"description": "The form cannot be read.", "content": _PROBLEM},
    406: {"description": "None of the accepted media types is offered.", "content": _PROBLEM},
    413: {"description": "The body is too long.", "content": _PROBLEM},
    415: {"description": "The body is no form.", "content": _PROBLEM},
    422: {"description": "The files settle no calibration; it is said why.", "content": _PROBLEM},
    503: {"description": "Another calibration runs; try again later.", "content": _PROBLEM},
}


@router.post(
    "/calibrations",
    summary="Calibrate a sensor from a turntable file",
    response_class=Response,
    responses=_RESPONSES,
    openapi_extra={"requestBody": _BODY},
)
async def calibrations(request: Request) -> Response:
    """Compare models on the files' own readings, judge the best, and write flight code.

    Same as `sunatlas calibrate`, with a limit of 60 s. Uploaded files are deleted after the answer.
    """
    wanted = media_type(request.headers.get("accept"), OFFERED)
    return await calibrated(request, wanted)


async def calibrated(request: Request, wanted: str) -> Response:
    """Return what the files of a form come to in a media type, or in what its field says.

    Raises
    ------
    Problem
        As `api.http.uploads.read_form`; 422 where the files settle no calibration, 503 where
        another calibration runs.
    """
    form = await read_form(request)
    wanted = _checked(form) or wanted
    if _BUSY.locked():
        detail = "Another calibration runs; try again in half a minute."
        raise Problem(503, "busy", detail, headers={"Retry-After": _RETRY_S})
    async with _BUSY:
        try:
            made = await asyncio.to_thread(
                calibrate_uploads,
                form.files,
                form.fields.get("config", ""),
                apply=form.fields.get("apply", "false") == "true",
                model=form.fields.get("model", "").strip(),
            )
        except UploadRefusedError as error:
            raise Problem(422, "no-calibration", str(error)) from error
    body, name = _written(made, wanted)
    headers = {"Cache-Control": "no-store", "Vary": "Accept"}
    if wanted == ZIP:
        headers["Content-Disposition"] = f'attachment; filename="{name}"'
    kind = "text/html; charset=utf-8" if wanted == HTML else wanted
    return Response(body, headers={**headers, "Content-Type": kind})


def _checked(form: Form) -> str | None:
    """Return the media type that the form asks for; refuse fields that there are not."""
    wrong = [
        Violation(
            name, None, f"a field, one of file, {', '.join(_FIELDS)}", nearest_name(name, _FIELDS)
        )
        for name in form.fields
        if name not in _FIELDS
    ]
    if wrong:
        raise Problem(400, "unknown-field", errors=wrong)
    allowed = {"apply": ("true", "false"), "answer": tuple(ANSWERS)}
    for name, words in allowed.items():
        given = form.fields.get(name)
        if given is not None and given not in words:
            error = Violation(name, given, f"one of {', '.join(words)}", nearest_name(given, words))
            raise Problem(422, "invalid-value", errors=[error])
    if not form.files:
        raise Problem(422, "invalid-value", errors=[Violation("file", None, "a file")])
    return ANSWERS.get(form.fields.get("answer", ""))


def _written(made: Mapping[str, str], wanted: str) -> tuple[bytes, str]:
    """Return the body in a media type, and the name that it is saved under."""
    if wanted == ZIP:
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, text in made.items():
                archive.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), text)
        return packed.getvalue(), "sun_sensor.zip"
    ending = ".json" if wanted == JSON else "_report.html"
    name = next(name for name in made if name.endswith(ending))
    return made[name].encode(), name
