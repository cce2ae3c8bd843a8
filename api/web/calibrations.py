"""The form that asks for a calibration, as it is sent; a calibration, as it is answered."""

from __future__ import annotations

from collections.abc import Mapping

from fastapi import Request, Response
from starlette.datastructures import UploadFile

from api.service.calibrations import archive_of
from api.web.negotiation import JSON
from calibrate.uploaded import Upload

HTML, ZIP = "text/html", "application/zip"
OFFERED = (JSON, HTML, ZIP)
#: What the field `answer` calls them.
ANSWERS: Mapping[str | None, str] = {"json": JSON, "report": HTML, "zip": ZIP}


async def sent(request: Request) -> tuple[dict[str, str], tuple[Upload, ...]]:
    """Return the fields and the files of a form; fields for files that were left empty are none.

    Raises
    ------
    Problem
        As `api.web.requests.StrictRequest.form`.
    """
    form = await request.form()
    try:
        fields = {name: part for name, part in form.multi_items() if isinstance(part, str)}
        parts = [part for _, part in form.multi_items() if isinstance(part, UploadFile)]
        files = [Upload(part.filename or "", await part.read()) for part in parts]
    finally:
        await form.close()
    return fields, tuple(file for file in files if file.name or file.data)


def as_response(made: Mapping[str, str], wanted: str) -> Response:
    """Return the products of a calibration in a media type."""
    headers = {"Cache-Control": "no-store", "Vary": "Accept"}
    if wanted == ZIP:
        headers["Content-Disposition"] = 'attachment; filename="sun_sensor.zip"'
        return Response(archive_of(made), headers=headers, media_type=ZIP)
    ending = ".json" if wanted == JSON else "_report.html"
    text = next(text for name, text in made.items() if name.endswith(ending))
    return Response(text, headers=headers, media_type=wanted)
