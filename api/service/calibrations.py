"""Files of a turntable to the products of their calibration, in a short queue."""

from __future__ import annotations

import asyncio
import io
import itertools
import os
import re
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from api.schema.calibrations import TICKET, CalibrationFields, Place
from api.service.asking import reading, refusing
from api.service.problems import Problem, Violation
from calibrate.uploaded import (
    Caller,
    Upload,
    UploadRefusedError,
    calibrate_uploads,
    preview_uploads,
)

#: Names a directory that all processes of a server share: a note there for each that waits.
SHARED = "SUNATLAS_SHARED"
#: Calibrations that wait at most in a process of the server, and seconds that each usually takes.
MOST_WAITING, _USUAL_S = 8, 10
#: Forms that arrive at once in a process: each takes a megabyte; the rest of it is on disk.
MOST_ARRIVING = 200
_Answer = TypeVar("_Answer")


@cache
def _own_notes() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory()


def _notes() -> Path:
    return Path(os.environ.get(SHARED) or _own_notes().name)


_numbers = itertools.count()


@contextmanager
def _noted(ticket: str) -> Iterator[None]:
    """Keep a note of a calibration, after those of this process that came before it."""
    note = _notes() / f"{os.getpid()}-{next(_numbers):012}-{ticket}"
    note.touch()
    try:
        yield
    finally:
        note.unlink(missing_ok=True)


def place(ticket: str) -> Place:
    """Return how many calibrations come before that of a ticket, in any process of the server."""
    known = _notes().glob(f"*-{ticket}") if re.fullmatch(TICKET, ticket) else iter(())
    note = next(known, None)
    if note is None:
        return Place(before=None, wait_s=None)
    of_process = _notes().glob(f"{note.name.partition('-')[0]}-*")
    before = sum(other.name < note.name for other in of_process)
    return Place(before=before, wait_s=_USUAL_S * before)


class _Queue:
    """Work in processes of their own, one at a time, as each keeps a core busy; others wait."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, "calibration")
        self.length = 0

    def require_place(self) -> None:
        if self.length > MOST_WAITING:
            raise _busy(f"{self.length} calibrations run or wait", _USUAL_S * self.length)

    async def answer(self, work: Callable[[Caller], _Answer]) -> _Answer:
        """Return what `work` gives in its turn; a `Problem` (422, 503) where it refuses.

        Where this is cancelled, the process of the work ends.
        """
        self.require_place()
        caller = Caller()
        turn = self._thread.submit(work, caller)
        turn.add_done_callback(lambda _: caller.close())
        self.length += 1
        try:
            return await asyncio.wrap_future(turn)
        except UploadRefusedError as error:
            raise Problem(422, "no-calibration", str(error)) from error
        finally:
            caller.hang_up()
            self.length -= 1
            del turn, work  # what it raises would hold itself by this, and the files


_CALIBRATIONS, _PREVIEWS = _Queue(), _Queue()


def require_place(arriving: int = 0) -> None:
    """Raise a `Problem` (503) where so many calibrations wait, or arrive, that none is taken."""
    if arriving > MOST_ARRIVING:
        raise _busy(f"{arriving} forms arrive", _USUAL_S)
    _CALIBRATIONS.require_place()


def _busy(said: str, wait_s: int) -> Problem:
    detail, headers = f"{said} here; try again in {wait_s} s.", {"Retry-After": str(wait_s)}
    return Problem(503, "busy", detail, headers=headers)


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
        422 where the files settle no calibration, 503 where too many others wait.
    """
    with _noted(fields.ticket):
        return await _CALIBRATIONS.answer(
            lambda caller: calibrate_uploads(
                files,
                fields.config,
                apply=fields.apply == "true",
                model=fields.model.strip(),
                require=fields.require.strip(),
                caller=caller,
            )
        )


async def previewed(files: Sequence[Upload]) -> dict[str, Any]:
    """Return what the first file seems to hold; a `Problem` as of `calibrated`."""
    return await _PREVIEWS.answer(lambda caller: preview_uploads(files, caller=caller))


def archive_of(made: Mapping[str, str]) -> bytes:
    """Return a ZIP of all products."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name, text in made.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            archive.writestr(entry, text, zipfile.ZIP_DEFLATED)
    return packed.getvalue()
