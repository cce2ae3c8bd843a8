"""Forms with files (multipart/form-data, RFC 7578), read by python-multipart within bounds."""

from __future__ import annotations

import logging
from collections.abc import AsyncGenerator, Mapping
from dataclasses import dataclass

from fastapi import Request
from starlette.datastructures import FormData, UploadFile
from starlette.formparsers import MultiPartException, MultiPartParser

from api.service.problems import Problem, Violation
from api.web.requests import FORM, bounded, in_time, require_body
from calibrate.uploaded import LARGEST, Upload

#: Bytes of fields, each and all: a config, and what separates parts. Of a body: files beside them.
LARGEST_FIELD = 100_000
LARGEST_BODY = LARGEST + LARGEST_FIELD
#: Files of a form, and fields; python-multipart bounds the heads of each (8 lines of 4 kB).
MOST_PARTS = 40
logging.getLogger("python_multipart").setLevel(logging.ERROR)  # what it refuses, we answer


@dataclass(frozen=True)
class Form:
    """Fields and files of a form.

    Attributes
    ----------
    fields : mapping of str to str
    files : tuple of Upload
        In the order of the form; fields for files that were left empty are none.
    """

    fields: Mapping[str, str]
    files: tuple[Upload, ...]


class _Parser(MultiPartParser):
    """A parser that refuses a form without an end, which lacks its last part."""

    ended = False

    def on_end(self) -> None:
        """Note the last boundary."""
        self.ended = True

    async def whole(self) -> FormData:
        """Return the form; where it is refused, its files are closed."""
        self.stream = self._to_its_end(self.stream)
        return await self.parse()

    async def _to_its_end(self, stream: AsyncGenerator[bytes, None]) -> AsyncGenerator[bytes, None]:
        async for chunk in stream:
            yield chunk
        if not self.ended:
            raise MultiPartException("no boundary ends it")


async def read_form(request: Request) -> Form:
    """Return the form that a request sends; files wait on disk until all has come.

    Raises
    ------
    Problem
        415 where it is none, 413 where it is too long, 408 where it comes too slowly, 400 where it
        cannot be read.
    """
    require_body(request, FORM, f"{FORM} with a boundary", LARGEST_BODY)
    try:
        async with in_time() as clock:
            chunks = bounded(request, LARGEST_BODY, clock)
            most = {"max_files": MOST_PARTS, "max_fields": MOST_PARTS}
            parser = _Parser(request.headers, chunks, **most, max_part_size=LARGEST_FIELD)
            form = await parser.whole()
    except MultiPartException as error:
        raise _malformed(str(error.__cause__ or error.message)) from error
    try:
        return await _form_of(form)
    finally:
        await form.close()


async def _form_of(form: FormData) -> Form:
    fields: dict[str, str] = {}
    files: list[Upload] = []
    for name, value in form.multi_items():
        if isinstance(value, UploadFile):
            data = await value.read()
            if value.filename or data:
                files.append(Upload(value.filename or "", data))
        elif name in fields:
            raise _malformed(f"field {name[:40]} stands twice")
        else:
            fields[name] = value
    return Form(fields, tuple(files))


def _malformed(reason: str) -> Problem:
    wrong = Violation("body", None, f"a form of RFC 7578 ({reason})")
    return Problem(400, "malformed-form", errors=[wrong])
