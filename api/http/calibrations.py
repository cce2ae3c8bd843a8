"""/v1/calibrations: files of a turntable to a calibration, its report and its code."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Path, Request, Response
from fastapi.responses import JSONResponse

from api.schema.calibrations import CalibrationFields, Place
from api.service import calibrations as service
from api.web.answers import StrictRoute
from api.web.calibrations import ANSWERS, HTML, OFFERED, ZIP, as_response, sent, while_there
from api.web.dependencies import NO_PARAMETERS
from api.web.negotiation import JSON, media_type

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
                    **CalibrationFields.model_json_schema()["properties"],
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
_PREVIEWED: dict[str, Any] = {
    "required": True,
    "content": {
        "multipart/form-data": {
            "schema": {
                "type": "object",
                "required": ["file"],
                "properties": {"file": {**_TEXT, "description": "As for a calibration."}},
            },
            "example": {"file": "x_px,y_px,alpha,beta\n1,2,3,4\n"},
        }
    },
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
    503: {"description": "Too many calibrations wait; try again later.", "content": _PROBLEM},
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

    Same as `sunatlas calibrate`, with a limit of 60 s of processor time. Uploaded files are deleted
    after the answer, or when the client hangs up.
    """
    wanted = media_type(request.headers.get("accept"), OFFERED)
    given, files = await sent(request)
    fields = service.read(given, files)
    made = await while_there(request, service.calibrated(fields, files))
    return as_response(made, ANSWERS.get(fields.answer, wanted))


@router.post(
    "/calibrations/preview",
    summary="Preview a turntable file",
    response_class=Response,
    responses={
        200: {
            "description": "Columns with role, unit and first values, notes, and a config.",
            "content": {JSON: {"schema": {"type": "object"}}},
        },
        **{status: said for status, said in _RESPONSES.items() if status not in {200, 406}},
    },
    openapi_extra={"requestBody": _PREVIEWED},
)
async def preview(request: Request) -> Response:
    """Guess the columns of a file from names and first rows. The file is deleted afterwards."""
    given, files = await sent(request)
    service.read(given, files)
    found = await while_there(request, service.previewed(files))
    return JSONResponse(found, headers={"Cache-Control": "no-store"})


@router.get(
    "/calibrations/waiting/{ticket}",
    summary="Place of a calibration in the queue",
    response_model=Place,
    responses={"4XX": {"description": "Refused; it is said why.", "content": _PROBLEM}},
)
async def waiting(
    ticket: Annotated[str, Path(description="As the form has it.")],
    request: Request,
    response: Response,
) -> Place:
    """Say how many calibrations come before one that was sent with this ticket. Never cached."""
    media_type(request.headers.get("accept"), (JSON,))
    response.headers["Cache-Control"] = "no-store"
    return service.place(ticket)
