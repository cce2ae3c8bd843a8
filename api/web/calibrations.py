"""A form with files of a turntable to the response that its calibration is."""

from __future__ import annotations

import asyncio
import io
import zipfile
from collections.abc import Mapping

from fastapi import Request, Response

from api.calibrate.uploaded import UploadRefusedError, calibrate_uploads
from api.service.problems import Problem, Violation
from api.web.negotiation import JSON
from api.web.uploads import Form, read_form
from survey_data.nearest import nearest_name

HTML, ZIP = "text/html", "application/zip"
OFFERED = (JSON, HTML, ZIP)
#: What the field `answer` calls them.
ANSWERS: Mapping[str, str] = {"json": JSON, "report": HTML, "zip": ZIP}
_FIELDS = ("config", "model", "apply", "answer")
#: One calibration at a time in a process of the server: each keeps a core busy.
_BUSY = asyncio.Semaphore(1)
_RETRY_S = "30"


async def calibrated(request: Request, wanted: str) -> Response:
    """Return what the files of a form come to in a media type, or in what its field says.

    Raises
    ------
    Problem
        As `api.web.uploads.read_form`; 422 where the files settle no calibration, 503 where
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
