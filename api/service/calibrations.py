"""Files of a turntable to the products of their calibration, one calibration at a time."""

from __future__ import annotations

import asyncio
import io
import zipfile
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from api.schema.calibrations import CalibrationFields
from api.service.asking import reading, refusing
from api.service.problems import Problem, Violation
from calibrate.uploaded import Upload, UploadRefusedError, calibrate_uploads, preview_uploads

#: One calibration, and one preview, at a time in a process of the server: each keeps a core busy.
_BUSY, _PREVIEWING = asyncio.Semaphore(1), asyncio.Semaphore(1)
_RETRY_S = "30"
_Answer = TypeVar("_Answer")


def read(fields: Mapping[str, str], files: Sequence[Upload]) -> CalibrationFields:
    """Return the fields of a form with files; a `Problem` (400, 422) for others, or no file."""
    with refusing(_fields):
        found: CalibrationFields = reading(_fields)(body=dict(fields))
    if not files:
        raise Problem(422, "invalid-value", errors=[Violation("file", None, "a file")])
    return found


def _fields(body: CalibrationFields) -> CalibrationFields:
    return body


async def calibrated(fields: CalibrationFields, files: Sequence[Upload]) -> Mapping[str, str]:
    """Return the text of each product by its name.

    Raises
    ------
    Problem
        422 where the files settle no calibration, 503 where another calibration runs.
    """
    return await _alone(
        _BUSY,
        lambda: calibrate_uploads(
            files,
            fields.config,
            apply=fields.apply == "true",
            model=fields.model.strip(),
            require=fields.require.strip(),
        ),
    )


async def previewed(files: Sequence[Upload]) -> dict[str, Any]:
    """Return what the first file seems to hold; a `Problem` as of `calibrated`."""
    return await _alone(_PREVIEWING, lambda: preview_uploads(files))


async def _alone(busy: asyncio.Semaphore, work: Callable[[], _Answer]) -> _Answer:
    if busy.locked():
        detail = "Another calibration runs; try again in half a minute."
        raise Problem(503, "busy", detail, headers={"Retry-After": _RETRY_S})
    async with busy:
        try:
            return await asyncio.to_thread(work)
        except UploadRefusedError as error:
            raise Problem(422, "no-calibration", str(error)) from error


def archive_of(made: Mapping[str, str]) -> bytes:
    """Return a ZIP of all products."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name, text in made.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            archive.writestr(entry, text, zipfile.ZIP_DEFLATED)
    return packed.getvalue()
