"""The form that asks for a calibration, as it is sent; a calibration, as it is answered."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine, Mapping, Sequence
from typing import Any, TypeVar

from fastapi import Request, Response
from starlette.datastructures import UploadFile
from starlette.requests import ClientDisconnect

from api.service.calibrations import archive_of, require_place
from api.web.negotiation import JSON
from benchmark.processes import release_free_memory
from calibrate.uploaded import Upload

HTML, ZIP = "text/html", "application/zip"
OFFERED = (JSON, HTML, ZIP)
#: What the field `answer` calls them.
ANSWERS: Mapping[str | None, str] = {"json": JSON, "report": HTML, "zip": ZIP}
_Answer = TypeVar("_Answer")
#: Seconds after which a form looks again whether files of another are read.
_TURN_S = 0.05
#: Seconds without a form after which memory goes back to the system.
_REST_S = 1.0


_arriving = 0


async def sent(request: Request) -> tuple[dict[str, str], tuple[Upload, ...]]:
    """Return the fields and the files of a form; fields for files that were left empty are none.

    Raises
    ------
    Problem
        As `api.web.requests.StrictRequest.form`; 503 where too many calibrations wait already.
    """
    global _arriving  # noqa: PLW0603 - of the process
    _arriving += 1
    try:
        require_place(_arriving)
        form = await request.form()
        try:
            fields = {name: part for name, part in form.multi_items() if isinstance(part, str)}
            parts = [part for _, part in form.multi_items() if isinstance(part, UploadFile)]
            files = await _in_memory(parts)
        finally:
            await form.close()
    finally:
        _arriving -= 1
        _release_soon()
    return fields, tuple(file for file in files if file.name or file.data)


_resting: asyncio.TimerHandle | None = None


def _release_soon() -> None:
    """Give memory that forms left free back to the system, once none has ended for a while.

    400 of 10 MB left 88 MB in a process, in pieces that nothing else fits in.
    """
    global _resting  # noqa: PLW0603 - of the process
    if _resting is not None:
        _resting.cancel()
    _resting = asyncio.get_running_loop().call_later(_REST_S, release_free_memory)


_reading = False


async def _in_memory(parts: Sequence[UploadFile]) -> list[Upload]:
    """Read files, which are on disk up to here: of one form at a time, as long as there is a place.

    Hundreds that arrive at once would all be read before the first of them takes a place.
    """
    global _reading  # noqa: PLW0603 - of the process
    while True:
        require_place()
        if not _reading:
            break
        await asyncio.sleep(_TURN_S)
    _reading = True
    try:
        return [Upload(part.filename or "", await part.read()) for part in parts]
    finally:
        _reading = False


async def while_there(request: Request, work: Coroutine[Any, Any, _Answer]) -> _Answer:
    """Return what `work` gives, which is cancelled when the client leaves; ClientDisconnect then.

    The body has to be read before.
    """

    async def leaves() -> None:
        while (await request.receive())["type"] != "http.disconnect":
            pass

    answered, left = asyncio.ensure_future(work), asyncio.ensure_future(leaves())
    try:
        await asyncio.wait((answered, left), return_when=asyncio.FIRST_COMPLETED)
        if not answered.done():
            raise ClientDisconnect
        return await answered
    finally:
        answered.cancel()
        left.cancel()
        del answered, work  # what it raises would hold itself by this, and the files


def as_response(made: Mapping[str, str], wanted: str) -> Response:
    """Return the products of a calibration in a media type."""
    headers = {"Cache-Control": "no-store", "Vary": "Accept"}
    if wanted == ZIP:
        headers["Content-Disposition"] = 'attachment; filename="sun_sensor.zip"'
        return Response(archive_of(made), headers=headers, media_type=ZIP)
    ending = ".json" if wanted == JSON else "_report.html"
    text = next(text for name, text in made.items() if name.endswith(ending))
    return Response(text, headers=headers, media_type=wanted)
