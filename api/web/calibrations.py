"""A form with files of a turntable to the response that its calibration is."""

from __future__ import annotations

import asyncio
import io
import json
import zipfile
from collections.abc import Callable, Mapping
from typing import TypeVar

from fastapi import Request, Response

from api.service.problems import Problem, Violation
from api.web.negotiation import JSON
from api.web.uploads import Form, read_form
from calibrate.uploaded import UploadRefusedError, calibrate_uploads, preview_uploads
from survey_data.nearest import nearest_name

HTML, ZIP = "text/html", "application/zip"
OFFERED = (JSON, HTML, ZIP)
#: What the field `answer` calls them.
ANSWERS: Mapping[str, str] = {"json": JSON, "report": HTML, "zip": ZIP}
_FIELDS = ("config", "model", "apply", "require", "answer")
#: One calibration, and one preview, at a time in a process of the server: each keeps a core busy.
_BUSY, _PREVIEWING = asyncio.Semaphore(1), asyncio.Semaphore(1)
_RETRY_S = "30"
_Answer = TypeVar("_Answer")


async def calibrated(request: Request, wanted: str) -> Response:
    """Return what the files of a form come to in a media type, or in what its field says.

    Raises
    ------
    Problem
        As `api.web.uploads.read_form` and `made_of`.
    """
    form = await read_form(request)
    wanted = checked(form) or wanted
    return as_response(await made_of(form), wanted)


async def previewed(request: Request) -> Response:
    """Return what the first file of a form seems to hold, as JSON.

    Raises
    ------
    Problem
        As `calibrated`.
    """
    form = await read_form(request)
    checked(form)
    found = await _alone(_PREVIEWING, lambda: preview_uploads(form.files))
    return Response(json.dumps(found), headers={"Cache-Control": "no-store", "Content-Type": JSON})


async def made_of(form: Form) -> Mapping[str, str]:
    """Return the text of each product by its name.

    Raises
    ------
    Problem
        422 where the files settle no calibration, 503 where another calibration runs.
    """
    fields = form.fields
    return await _alone(
        _BUSY,
        lambda: calibrate_uploads(
            form.files,
            fields.get("config", ""),
            apply=fields.get("apply", "false") == "true",
            model=fields.get("model", "").strip(),
            require=fields.get("require", "").strip(),
        ),
    )


def as_response(made: Mapping[str, str], wanted: str) -> Response:
    """Return products in a media type."""
    body, name = _written(made, wanted)
    headers = {"Cache-Control": "no-store", "Vary": "Accept"}
    if wanted == ZIP:
        headers["Content-Disposition"] = f'attachment; filename="{name}"'
    kind = "text/html; charset=utf-8" if wanted == HTML else wanted
    return Response(body, headers={**headers, "Content-Type": kind})


async def _alone(busy: asyncio.Semaphore, work: Callable[[], _Answer]) -> _Answer:
    if busy.locked():
        detail = "Another calibration runs; try again in half a minute."
        raise Problem(503, "busy", detail, headers={"Retry-After": _RETRY_S})
    async with busy:
        try:
            return await asyncio.to_thread(work)
        except UploadRefusedError as error:
            raise Problem(422, "no-calibration", str(error)) from error


def checked(form: Form) -> str | None:
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
        return archive_of(made), "sun_sensor.zip"
    ending = ".json" if wanted == JSON else "_report.html"
    name = next(name for name in made if name.endswith(ending))
    return made[name].encode(), name


def archive_of(made: Mapping[str, str]) -> bytes:
    """Return a ZIP of all products."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name, text in made.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            archive.writestr(entry, text, zipfile.ZIP_DEFLATED)
    return packed.getvalue()
